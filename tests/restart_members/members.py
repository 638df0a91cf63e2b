# SPDX-License-Identifier: MIT
"""Members of parts of a run that checkpoints need not contain, NOT_STORED, and that need not be rolled back after a
failed step, NOT_SAVED, with the reason. See check.py. A class is a part also because it is listed here."""

# Reasons that many members have.
GIVEN = "given by the program that reads the checkpoint"
ANEW = "found anew, before it is used, from what is stored"
ROLLBACK = "used only within a step, to roll it back"
MEMORY = "memory that is used again; its contents are replaced before they are read"
NUMBER = "a number that no other run has: it tells whether data belong together, which reading decides anew"
CLOCK = "wall-clock time, which has no effect on results"
LAST = "a result of the last step, which observers read after it; the next step replaces it"
UNCHANGED = "not changed by steps"
SUCCESS = "changed only when the step has succeeded"
UPDATE = "of the last update, which the repeated step makes again"


def all_of(reason, names):
    return {name: reason for name in names.split()}


def particles(of_table, **further):
    """Of particles and of their base, whose members they have as well."""
    return {"ParticleTable": of_table, "Particles": {**of_table, **further}}


NOT_STORED = {
    # core
    "Columns<Dim,Real,std::tuple<All...>>": {"units_": "Particles::transfer() names their fields"},
    "TimeLevels": {"now_": "Particles::transfer() names its fields",
                   **all_of(ROLLBACK, "other_ spare_ is_kept_ is_next_ advanced_")},
    **particles({"ids_": "Particles::transfer() names them",
                 **all_of("ghosts: those of the last update of the search, which makes them again when it is "
                          "read", "owners_ shifts_"),
                 **all_of(NUMBER, "revision_ owned_revision_ rows_revision_ is_copy_ ghosts_revision_ "
                                  "positions_changed_ constants_changed_ constants_revision_"),
                 "travel_": "a bound that only saves time",
                 **all_of("of the halo, which processes find anew", "halo_ state_changed_")}),
    "Gravity": {"g_": GIVEN},
    "Forces": {"parts_": "for_each_part() passes them to transfer_part()"},
    "Simulation": {"saved_integrator_": ROLLBACK, "chooses_radius_": GIVEN, "thread_choice_": CLOCK},
    # search
    "BruteForce": {"radius_": GIVEN, **all_of(ANEW, "owned_ owners_")},
    "UniformGrid": {"radius_": GIVEN, "saved_descents_": ROLLBACK, **all_of(ANEW, "owned_ points_ ghost_owners_")},
    "LevelGrid": {"radius_": GIVEN,
                  **all_of(ANEW, "gap_ owned_ radii_ owners_ highest_ levels_ by_level_"),
                  **all_of(MEMORY, "histogram_ all_levels_")},
    "ListGrid": all_of(ANEW, "inner_ levels_ has_long_rows_"),
    "LastPositions": {"positions_": "NeighbourList::transfer() names them: last",
                      "update_": NUMBER, "maxima_": MEMORY, **all_of(ROLLBACK, "previous_ has_previous_ saved_")},
    "NeighbourList": {"radius_": GIVEN, **all_of(NUMBER, "state_.list.revision state_.list.owned_revision"),
                      **all_of(ANEW, "rows_ state_.list.owned is_lost_"),
                      "positions_": "the entry `last` has those of owned particles; the others are found anew",
                      **all_of(ROLLBACK, "saved_ previous_reference_ keeps_previous_ saved_requested_")},
    "Skin": {"tunes_": GIVEN},
    "TimedSearch": {"watch_": CLOCK},
    "TimedInteraction": {"watch_": CLOCK},
    # integrate
    "Leapfrog": {
        "damping_": GIVEN,
        "max_energy_gain_": "of the last step, for the check after it",
    },
    # dem
    "Bonds": {"law_": GIVEN, "indices_": ANEW,
              **all_of(ROLLBACK, "kept_bonds_ kept_broken_ kept_time_step_ is_kept_")},
    "ContactsOf": {**all_of(GIVEN, "materials_ settings_"),
                   **all_of("a function of the constants of the grains", "radii_ shortest_"),
                   "time_": "set_time() sets it before it is used",
                   "last_time_step_": "set_last_time_step() sets it before it is used", "memory_": MEMORY},
    "ListOfStep": {"is_input_kept_": "decides which memory is used",
                   "is_rebuild_announced_": "between needs_rebuild() and the evaluation, within a step",
                   "state_.last.list": "saved_list() has it",
                   "state_.last.after": "ContactsOf::history() has them",
                   **all_of(LAST, "state_.last.list_before state_.last.before state_.last.grains state_.last.box "
                                  "state_.last.count state_.last.added_blocks state_.last.step"),
                   "state_.last.lifetime": "a bound that only saves time: is_stale() decides the same without it",
                   "state_.given_history": "ContactsOf::history() has it",
                   "saved_": ROLLBACK, "memory_": MEMORY},
    "SavedList": all_of("is that of a box without periodic sides", "origin_.extent.periodic origin_.extent.on_escape"),
    "ReusableList": {**all_of("SavedList names them", "since margin time extent stable_time_step added contacts"),
                     **all_of(NUMBER, "rows_revision walls_revision"), **all_of(ANEW, "boxes largest_radius contact_gap"),
                     "constants": "those of the grains: a list of others is not stored"},
    "Histories": {"numbers_": "ContactsOf::history() has them", "touching_": "ContactsOf::history() has them"},
    "ClumpLeapfrog": {"damping_": GIVEN},
    "Clumps": all_of(ANEW, "grains_ indices_"),
    "MeanMotion": {**all_of(ANEW, "clumps_ driven_ duration_ v_ w_ stays_"),
                   "carried_away_": "EnergyLedger::added_since_ has it at the end of a step"},
    "WallWear": all_of(GIVEN, "settings_"),
    "WallSet": {**all_of(GIVEN, "walls_ first_ materials_"), "revision_": NUMBER},
    "Inflow": {**all_of(GIVEN, "region_ blend_ settings_"), "near_": ANEW},
    "Outflow": all_of(GIVEN, "region_ settings_"),
    "PistonInOpening": all_of(GIVEN, "opening_ plane_ motion_"),
    "PressureOpening": all_of(GIVEN, "settings_ plane_"),
    # mps
    "BasicFlow": {"settings_": GIVEN,
                  **all_of(ANEW, "operators_ force_ friction_ pressure_ changes_ advection_"),
                  "seconds_": CLOCK},
    "FlowPressure": {"solver_": GIVEN, "report_": LAST,
                     **all_of(ANEW, "boundary_ moments_ source_ equation_ surface_pressures_")},
    "FlowRecord": {"viscous_limit_": GIVEN, "is_first_step_": ANEW, "momentum_changes_": LAST, "saved_": ROLLBACK,
                   "time_": "set_time() sets it before it is used", "work_of_walls_": ANEW},
    "MomentumChanges": all_of(LAST, "all_ saved_"),
    "Advection": {"moved_with_": ANEW},
    "FlowOperators": {**all_of(GIVEN, "stencil_ laplacian_stencil_"),
                      **all_of(ANEW, "neighbourhood_ laplacian_neighbourhood_ bulk_volumes_"),
                      "walls_": "those that move; others have the same bits whenever they are found, see WallModel"},
    "WallMotions": {"mover_": "for_each_number() passes its state"},
    "MovingWallsInFlow": {**all_of(GIVEN, "groups_ is_solid_"), **all_of(ANEW, "contacts_ coupling_ holds_bodies_ loads_ time_step_"),
                          "now_": "WallMotions passes for_each_number(); begin_step() sets now_.last from now_.steps",
                          "bodies_": "for_each_number() passes them", "saved_": ROLLBACK},
    "BodyInFlow": {**all_of(GIVEN, "body_ mass_ volume_ centre_of_volume_ deviation_ largest_distance_"),
                   **all_of(ANEW, "time_step_ load_of_user_"),
                   "now_": "WallMotions passes for_each_number()",
                   "saved_": ROLLBACK},
    "WallNormals": {"normals_": "the same bits whenever they are found, see find()",
                    **all_of("tells whether the normals are those of the present walls", "positions_ kinds_"),
                    "revision_": NUMBER},
    "Neighbourhood": {**all_of(ANEW, "positions_ rows_ sets_ density_"), "revision_": NUMBER},
    "BodyForce": {"gravity_": GIVEN, "forces_": ANEW},
    "PressureBoundary": all_of(ANEW, "has_pressure_ weight_of_surface_ near_boundary_"),
    "KeptMoments": all_of(ANEW, "is_known_ moments_"),
    "ErrorCompensatingSource": {"last_rate_": ANEW},
    "PressureEquation": {**all_of(ANEW, "system_ unknowns_ row_of_ last_column_ closed_bodies_"),
                         "solution_": "begins with the pressures of the particles"},
    "EnergyAccount": {"properties_": GIVEN},
    "FlowWatch": all_of(ANEW, "kinetic_ speed_of_step_ speed_of_walls_"),
    # coupled
    "FluidForces": {"drag_": GIVEN, **all_of("Coupled sets it by begin() before each of its steps", "fluid_ acted_for_ counts_ work_"),
                    **all_of(ROLLBACK, "saved_ saved_work_"), "works_": ANEW,
                    "last_time_step_": "set_last_time_step() sets it before it is used"},
    "Coupled": {"exchange_": ANEW, **all_of(ROLLBACK, "saved_grains_ saved_"),
                "thread_choice_": CLOCK},
    # solve
    "ConjugateGradient": {"settings_": GIVEN, "preconditioner_": "prepare() makes it anew in every solve",
                          **all_of(MEMORY, "r_ z_ p_ q_ partial_")},
    "EigenConjugateGradient": {"settings_": GIVEN},
    "EigenConjugateGradient::Factors": all_of(ANEW, "system_ factors_"),
    "IncompleteCholesky": all_of(ANEW, "factors_ diagonal_"),
    "Jacobi": all_of(ANEW, "inverse_"),
    "CellMultigrid": {"settings_": GIVEN,
                      **all_of(ANEW, "inverse_ occupied_ finest_cells_ to_particles_ stiffness_ stiffness_of_points_ cycle_ uses_cells_")},
    "CellCycle": {"settings_": GIVEN, **all_of(ANEW, "levels_ coarsenings_ used_ coarsest_inverse_")},
    "SharedCellCycle": all_of(ANEW, "world_ agree_ owners_ exchange_ has_users_ level_ matrix_ multigrid_ b_ x_"),
    "CellExchange": all_of(ANEW, "own_ numbers_ first_ all_ to_owners_ to_users_"),
    "HypreMultigrid": all_of(ANEW, "multigrid_ matrix_ b_ x_ rows_ zeros_"),
    "BoomerAmg": {"settings_": GIVEN, **all_of(ANEW, "multigrid_ matrix_")},
    # measure and io
    "Profiles": {"slices_": GIVEN, "sample_": MEMORY},
    "Flux": {"section_": GIVEN, **all_of("found before each step", "near_ pose_")},
    "CsvFile": all_of(GIVEN, "path_ columns_"),
    "CsvSeries": {"measures_": "each has an entry of its own", "at_outputs_": GIVEN},
    "VtkSeries": {"folder_": GIVEN},
    "Checkpoints": {**all_of(GIVEN, "path_ every_ parts_"), "written_": CLOCK},
    "Progress": {**all_of(GIVEN, "stream_ is_terminal_ clock_"),
                 **all_of("of the line that shows the progress of this process", "begun_ is_ended_ wall_begin_ "
                          "wall_next_ run_begin_ time_begin_ last_")},
    "StopOnSignal": {"handled_": GIVEN},
    # examples
    "Recorder": {"measure_": GIVEN},
    "Weight": all_of(GIVEN, "grain load"),
    "Ledger": {"options_": GIVEN},
    "Wave": {"options_": GIVEN},
    "Spreading": {"options_": GIVEN},
    "Statistics": all_of(GIVEN, "options_ gauges_"),
    "FrontGauge": {"spacing_": GIVEN},
    "PressureGauges": {"probes_": GIVEN, "row_": LAST},
    "Notes": all_of(GIVEN, "flow_ on_row_"),
    "Averages": {"options": GIVEN},
    "Frames": {"samples_per_frame": GIVEN},
}

NOT_SAVED = {
    # core
    "TimeLevels": {**all_of("restore() copies the owned particles; the search makes the ghosts anew",
                            "now_.ghosts other_.ghosts"),
                   "spare_": MEMORY, "advanced_": "begin_advance() clears it"},
    **particles({**all_of("the step removes particles when nothing can fail any more", "ids_"),
                 **all_of("ghosts: the search makes them anew", "owners_ shifts_ ghosts_revision_"),
                 **all_of(NUMBER, "revision_ owned_revision_ rows_revision_ is_copy_ positions_changed_ "
                                  "constants_changed_ constants_revision_"),
                 "travel_": "positions_changed_ begins it anew",
                 "halo_": "changed between steps", "state_changed_": "decides whether the halo is sent again"},
                box_=UNCHANGED),
    "Forces": {"parts_": "for_each_part() saves and restores each"},
    "Simulation": {"chooses_radius_": GIVEN, "thread_choice_": CLOCK,
                   **all_of(SUCCESS, "steps_ particles_lost_ time_ last_time_step_"),
                   "was_read_": UNCHANGED, "run_": "changed by run(), between steps"},
    # search
    "UniformGrid": {"radius_": "Simulation::prepare() sets it before every step",
                    **all_of(UPDATE, "owned_ revision_ points_ ghost_owners_")},
    "LastPositions": {"maxima_": MEMORY},
    "NeighbourList": {"radius_": "Simulation::prepare() sets it before every step",
                      **all_of("recover() builds them again, from the positions before the step", "grid_ rows_"),
                      "image_": "a function of the box, which steps do not change"},
    # dem
    "Bonds": {"law_": GIVEN, "indices_": ANEW,
              "stability_": "of the constants of the grains and the bonds before the step, and found again to the same bits"},
    "ContactsOf": {**all_of(GIVEN, "materials_ settings_"),
                   "walls_": "the program takes them away and puts them back between steps",
                   **all_of("a function of the constants of the grains", "radii_ shortest_"),
                   "time_": "set_time() sets it before it is used",
                   "last_time_step_": "set_last_time_step() sets it before it is used", "memory_": MEMORY},
    "ListOfStep": {"memory_": MEMORY},
    # coupled
    "FluidForces": {**all_of(GIVEN, "drag_ coefficients_"), "works_": ANEW, "last_time_step_": "set_last_time_step() sets it before it is used",
                    **all_of("begin() sets it, between steps", "fluid_ counts_")},
    "Coupled": {"exchange_": ANEW, **all_of(SUCCESS, "time_ last_time_step_ steps_ energy_"), "thread_choice_": CLOCK,
                "run_": "changed by run(), between steps"},
    # mps
    "BasicFlow": {"settings_": GIVEN,
                  **all_of(ANEW, "operators_ force_ friction_ changes_ advection_"),
                  "pressure_": "found anew; the report of its solver tells why the step failed", "seconds_": CLOCK},
    "FlowRecord": {"viscous_limit_": GIVEN, "is_first_step_": ANEW,
                   "time_": "set_time() sets it before it is used", "work_of_walls_": ANEW},
    "FlowOperators": {**all_of(GIVEN, "stencil_ laplacian_stencil_"),
                      **all_of(ANEW, "neighbourhood_ laplacian_neighbourhood_ bulk_volumes_")},
    "WallMotions": {"mover_": "save() and restore() are those of the mover"},
    "MovingWallsInFlow": {**all_of(GIVEN, "groups_ is_solid_"),
                          **all_of(ANEW, "contacts_ coupling_ holds_bodies_ loads_ time_step_")},
    "BodyInFlow": {**all_of(GIVEN, "body_ mass_ volume_ centre_of_volume_ deviation_ largest_distance_"),
                   **all_of(ANEW, "time_step_ load_of_user_")},
}
