#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that every public declaration of the library has a documentation comment.

    check_comments.py [--count] REPOSITORY [FLAGS-FILE]   of the compiler's flags, -I and -isystem are
                                                          used
    check_comments.py --self-test                         checks that every kind of fault is found

Public is what is neither in a namespace `detail` nor private or protected, in the headers below
include/silt. Clang parses them (Debian: python3-clang-19), so that a comment belongs to a declaration
if the compiler says so: `///` before it, or `///<` behind it. Prints each fault as file:line: message
and exits with 1; exits with 77 if clang's Python module is not installed. Headers that include one
of an optional library that is missing are left out. --count prints how many declarations there are.

A comment must say something:

  * that of a function that throws by itself, with fail() or a require_…(), says so;
  * that of a function that returns a floating-point number or vector, or of a member of a struct
    that is one, has a unit in brackets: [m], [-], [unit of the field];
  * a source in brackets, [SahChoi2004], is in docs/references.bib.

Some declarations need no comment of their own, because it would only repeat what a reader already
knows: see needs_no_comment() and the tables below, each with its reason.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

try:
    from clang import cindex
    from clang.cindex import AccessSpecifier, CursorKind
except ImportError:
    cindex = None

SKIPPED = 77
SYSTEM_PYTHON = "/usr/bin/python3"  # Debian's packages of modules are for this interpreter alone

# Members that an interface requires of every class that models it: the interface, a concept or the
# function that calls the member, documents shape, unit and what is thrown. A name that is also used
# with another meaning is not here. Every name must occur in the text of its interface.
INTERFACES = {
    "ParticleSet": ["Real", "Vec", "dimension"],
    "NeighbourSearch": ["set_radius", "update", "for_each_neighbour", "for_each_pair"],
    "SortsParticles": ["sort"],
    "for_each_candidate": ["for_each_candidate"],
    "margin_of": ["margin"],
    "ForParticles": ["For", "Description"],
    "explain": ["explain"],
    "HasReach": ["reach"],
    "Interaction": ["accelerate"],
    "AddsForces": ["add_forces"],
    "needs_search": ["needs_search"],
    "DependsOnTime": ["set_time"],
    "DependsOnLastTimeStep": ["set_last_time_step"],
    "AdvancesField": ["advances"],
    "Integrator": ["step"],
    "ChoosesTimeStep": ["time_step"],
    "LimitsTimeStep": ["limit_of_time_step"],
    "Transactional": ["save", "restore"],
    "Transferable": ["transfer"],
    "Damping": ["kicked", "drag", "half_step_before"],
    "ActsBeforeSteps": ["before_step"],
    "ObservesSteps": ["after_step"],
    "ActsBetweenSteps": ["between_steps"],
    "EndsRuns": ["stop_requested"],
    "ChecksSteps": ["check_step"],
    "ChecksEnergy": ["check_energy"],
    "Shared": ["together", "report_fault", "have_all_thrown", "moved_since_halo", "update_halo",
               "finish_step", "refresh_halo", "find_halo_of_changed", "exchange", "exchange_back",
               "gather", "keep_own", "depth_of_halo", "exchange_of", "ElementExchange"],
    "ContactLaw": ["stiffness", "elastic_energy", "elastic_energies", "components", "mix", "check"],
    "LawWithHistory": ["History"],
    "NormalComponent": ["normal_force"],
    "TangentialComponent": ["tangential_force"],
    "RollingComponent": ["rolling_couple"],
    "AdhesionComponent": ["adhesion_force"],
    "SimpleWall": ["nearest"],
    "CompositeWall": ["element_count", "for_each_element_near"],
    "WallAtRest": ["material", "check_in", "checksum"],
    "RigidMotion": ["pose_at", "velocity_at", "period"],
    "Region": ["clearance", "bounds", "volume"],
    "Kernel": ["weight"],
    "SmoothKernel": ["slope", "curvature"],
    "Gradient": ["evaluate"],
    "LaplacianWeights": ["weights"],
    "Displaces": ["displacement"],
    "PressureSource": ["needs_moved_particles"],
    "UsesLastPressure": ["uses_last_pressure"],
    "FreeSurface": ["is_on_surface"],
    "HasOuterSurface": ["weight_of_surface"],
    "CollisionModel": ["velocity_change"],
    "WallModel": ["InFlow"],
    "WallsInFlow": ["divergence", "is_dry", "has_pressure"],
    # The comment at the top of this header.
    "core/transfer.hpp": ["reads", "same", "setup", "within", "finite", "require_left"],
    "Preconditioner": ["prepare", "apply", "shares_unknowns"],
}

# The same for classes that the interface names as its models: these names have other meanings
# elsewhere.
MODELS = {
    "SizeDistribution": ["radius", "largest"],
    "NeighbourSearch": ["radius"],
    "Shared": ["sum", "largest", "process", "world"],
    "mps/scheme/scheme.hpp": ["source", "collision", "kernel", "surface", "gradient", "walls", "shifting",
                       "friction", "wall_stress", "laplacian"],
    "CellMultigrid": ["finest", "solve", "share", "add_of_others"],
    "MotionInColumns": ["State", "at_once", "is_in_rows", "change_velocities", "drift",
                        "store", "Outcome", "energy_before", "energy_after"],
}

# Members that mean the same as in the containers and iterators of the standard library.
STANDARD = {
    "size", "empty", "begin", "end", "front", "back", "data", "clear", "reserve", "iterator",
    "value_type", "difference_type", "reference", "pointer", "iterator_category", "type", "value",
}

# Operators are applied, not called: the comment of the class says what its objects are, and thereby
# what the sum of two, or a call of one, is.
OPERATOR = re.compile(r"operator\W")

# Types whose name says everything: an aggregate of the parameters of its class, each with a comment.
SELF_EVIDENT_TYPES = {"Settings"}

# What throws, and words that tell it.
FAILS = re.compile(r"\b(fail|fail_as_unstable|require_\w+)\s*\(")
SAYS_THROWS = re.compile(r"\b[Tt]hrow|\brefuse")
UNIT = re.compile(r"\[[^\]\s][^\]]*\]")
FLOATING = re.compile(r"(const )?(double|float|Real|RealType|(typename )?\w+::(Real|Vec|Scalar)|"
                      r"(silt::)?(Angular)?Vec(<.*>)?)( ?&)?$")
# The unit is that of the arguments, or of the function that the comment names.
UNIT_IS_ELSEWHERE = re.compile(r"\b([Ss]ee|[Ss]ame|of the values|lanes)\b")
MATHEMATICS = ("silt/core/types.hpp", "silt/core/vectors.hpp")
INCLUDE = re.compile(r"^\s*#\s*include\s*<([^>]+)>", re.M)
SOURCE = re.compile(r"\[([A-Z]\w*?(?:19|20)\d\d)\]")

if cindex is not None and hasattr(CursorKind, "CONCEPT_DECL"):
    CLASSES = {CursorKind.CLASS_DECL, CursorKind.STRUCT_DECL, CursorKind.UNION_DECL,
               CursorKind.CLASS_TEMPLATE, CursorKind.CLASS_TEMPLATE_PARTIAL_SPECIALIZATION}
    ALIASES = {CursorKind.TYPE_ALIAS_DECL, CursorKind.TYPE_ALIAS_TEMPLATE_DECL,
               CursorKind.TYPEDEF_DECL}
    FUNCTIONS = {CursorKind.FUNCTION_DECL, CursorKind.FUNCTION_TEMPLATE, CursorKind.CXX_METHOD,
                 CursorKind.CONSTRUCTOR, CursorKind.DESTRUCTOR, CursorKind.CONVERSION_FUNCTION}
    VALUES = {CursorKind.VAR_DECL, CursorKind.FIELD_DECL, CursorKind.ENUM_CONSTANT_DECL}
    # Templates of variables have no kind of their own.
    DECLARATIONS = CLASSES | ALIASES | FUNCTIONS | VALUES | {
        CursorKind.CONCEPT_DECL, CursorKind.ENUM_DECL, CursorKind.UNEXPOSED_DECL}


class Declaration:
    """A public declaration; `parent` is the class or enumeration that has it as a member, `source`
    its text, up to the next declaration."""

    def __init__(self, cursor, parent, scope, source):
        self.cursor = cursor
        self.kind = cursor.kind
        self.parent = parent
        self.scope = scope
        # A constructor of a template is called Name<Argument>.
        self.name = re.match(r"operator.*|\w+|.*", cursor.spelling)[0]
        self.qualified = "::".join([*scope, self.name])
        self.file = cursor.location.file.name
        self.line = cursor.location.line
        self.source = source
        self.comment = cursor.raw_comment or self.comment_beside()
        self.comment_of_class = self.comment
        self.declares_variable = False

    def comment_beside(self):
        """What Doxygen takes for its comment and clang does not: behind a function or alias, or before
        a function that is a template because of an argument `auto`."""
        behind = re.search(r"^(?!\s*//).*?(///<.*)$", self.source, re.M)
        if self.kind in FUNCTIONS | ALIASES and behind:
            return behind[1]
        if self.cursor.extent.start.line == 0:
            lines = pathlib.Path(self.file).read_text("utf-8").splitlines()
            before = lines[self.line - 2].strip()
            return before if before.startswith("///") else ""
        return ""

    @property
    def code(self):
        return re.sub(r"//.*", "", self.source)

    @property
    def type_name(self):
        """The type of a member or variable, or what a function returns."""
        returns = self.kind in FUNCTIONS
        return (self.cursor.result_type if returns else self.cursor.type).spelling

    @property
    def is_special_member(self):
        """Copies, moves, destroys or makes without arguments: the language defines what it does."""
        cursor = self.cursor
        return (self.kind == CursorKind.DESTRUCTOR or cursor.is_copy_constructor() or
                cursor.is_move_constructor() or self.name.startswith("operator=") or
                self.kind == CursorKind.CONSTRUCTOR and
                re.match(r"[\w\s]*\(\s*\)", self.code) is not None)

    def holds(self, other):
        """Whether the other one is a part of this declaration: struct {…} name;"""
        outer, inner = self.cursor.extent, other.cursor.extent
        return (self.file == other.file and outer.start.offset <= inner.start.offset and
                inner.end.offset <= outer.end.offset)


def declarations_of(unit, root):
    """Yields every public declaration in the files below root."""
    texts = {}
    classes = {}

    def begin_of(cursor):
        # Of a template because of an argument `auto`, the extent is not known.
        return cursor.extent.start.offset or cursor.location.offset

    def members_of(cursor):
        """The declarations in it, each with its text up to the next one."""
        found = [each for each in cursor.get_children()
                 if each.location.file and each.location.file.name.startswith(root)]
        for each, following in zip(found, [*found[1:], None]):
            name = each.location.file.name
            if name not in texts:
                texts[name] = pathlib.Path(name).read_bytes()
            end = cursor.extent.end.offset if cursor.location.file else len(texts[name])
            if following and following.location.file.name == name:
                end = max(begin_of(following), each.extent.end.offset)
            yield each, texts[name][begin_of(each):end].decode()

    def walk(cursor, parent, scope):
        last_class = None
        for child, source in members_of(cursor):
            if child.kind == CursorKind.NAMESPACE:
                if child.spelling != "detail" and (scope or child.spelling == "silt"):
                    yield from walk(child, None, [*scope, child.spelling])
                continue
            # Outside of silt are specialisations of templates of other libraries.
            if (not scope or child.kind not in DECLARATIONS or
                    child.access_specifier in (AccessSpecifier.PRIVATE, AccessSpecifier.PROTECTED)):
                continue
            if parent is None and child.semantic_parent.kind in CLASSES:
                # Defined outside of its class. As a function it was checked there.
                if child.kind not in CLASSES:
                    continue
                of = "::".join([*scope, child.semantic_parent.spelling])
                own = Declaration(child, classes[of], of.split("::"), source)
            else:
                own = Declaration(child, parent, scope, source)
            if own.kind == CursorKind.VAR_DECL and last_class and own.holds(last_class):
                last_class.declares_variable = True
            if own.kind in CLASSES:
                last_class = own
                # A specialisation, or a definition after the declaration, has its comment there.
                if not own.comment and own.qualified in classes:
                    own.comment_of_class = classes[own.qualified].comment_of_class
                classes[own.qualified] = own
            yield own
            if child.kind in CLASSES or child.kind == CursorKind.ENUM_DECL:
                yield from walk(child, own, own.qualified.split("::"))

    yield from walk(unit.cursor, None, [])


def names(comment, word):
    return re.search(rf"(?<!\w){re.escape(word)}(?!\w)", comment) is not None


def texts_of_interfaces(declarations):
    """The comment and text of each entry of INTERFACES and MODELS."""
    texts = {}
    for own in declarations:
        if own.parent is None and (own.name in INTERFACES or own.name in MODELS):
            texts[own.name] = texts.get(own.name, "") + own.comment + own.source
        for header in (*INTERFACES, *MODELS):
            if header not in texts and own.file.endswith("/" + header):
                texts[header] = pathlib.Path(own.file).read_text("utf-8").split("#pragma")[0]
    return texts


def needs_no_comment(own, documented, interfaces):
    """Why this declaration needs no comment of its own; None if it needs one. `documented` has the
    scopes and names of the declarations before it that have a comment."""
    if own.kind == CursorKind.CLASS_TEMPLATE_PARTIAL_SPECIALIZATION or (
            own.kind in CLASSES and own.source.startswith("template <>")):
        return "does the same as the template"
    if own.kind in CLASSES and own.declares_variable:
        return "is the type of a variable: struct mass_t {} mass"
    if own.cursor.spelling.startswith("<deduction guide"):
        return "is not called"
    if own.is_special_member:
        return "is defined by the language"
    if OPERATOR.match(own.name):
        return "is an operator"
    if (tuple(own.scope), own.name) in documented:
        return "is an overload of one that has a comment"
    if own.parent is None:
        return None
    about_class = own.parent.comment_of_class
    if own.name in STANDARD:
        return "is known from the standard library"
    if any(own.name in members for members in INTERFACES.values()):
        return "belongs to an interface"
    if any(own.name in members and names(interfaces.get(interface, ""), own.parent.name)
           for interface, members in MODELS.items()):
        return "belongs to an interface"
    if own.kind in CLASSES and own.name in SELF_EVIDENT_TYPES:
        return "says everything by its name"
    if own.kind in ALIASES:
        target = own.source.split(";")[0].split("=")[-1].strip()
        if re.search(rf"{own.name}(<.*>)?$", target, re.S):
            return "is called as its type, like Cell = GridCell<Dim>"
    if own.kind == CursorKind.FIELD_DECL or own.kind == CursorKind.CXX_METHOD and not list(
            own.cursor.get_arguments()):
        plain = re.sub(r"<.*>|\bconst\b|&", "", own.type_name).split("::")[-1].strip()
        in_words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", plain).lower()
        if re.search(rf"(^|_){own.name}$", in_words):
            return "is called as its type, like lever_arm of a LeverArm"
    if own.kind == CursorKind.FIELD_DECL and re.search(r"\b[Aa]ll in \[", about_class):
        return "has the unit that its class gives for all members"
    if own.kind in ALIASES | VALUES:
        if names(about_class, own.name):
            return "is described by its class"
    elif f"{own.name}(" in about_class:
        return "is described by its class"
    return None


def faults_of(declarations):
    """Yields (declaration, message)."""
    documented = {}
    interfaces = texts_of_interfaces(declarations)
    for own in declarations:
        place = (tuple(own.scope), own.name)
        reason = needs_no_comment(own, documented, interfaces)
        comment = own.comment or documented.get(place, "")
        if own.comment:
            documented[place] = own.comment
        elif reason is None:
            yield own, f"{own.qualified} has no comment"
        if not comment:
            continue
        is_of_interface = any(own.name in members for members in INTERFACES.values())
        if own.kind in FUNCTIONS and FAILS.search(own.code) and not SAYS_THROWS.search(comment):
            if own.name not in {"check", "transfer"}:  # whose interface says so
                yield own, f"the comment of {own.qualified} does not say what is thrown"
        needs_unit = own.kind == CursorKind.FIELD_DECL or own.kind in FUNCTIONS and not (
            is_of_interface or own.file.endswith(MATHEMATICS) or OPERATOR.match(own.name) or
            UNIT_IS_ELSEWHERE.search(comment))
        if needs_unit and FLOATING.match(own.type_name):
            about_class = own.parent.comment_of_class if own.kind in VALUES else ""
            if not UNIT.search(comment + about_class):
                yield own, f"the comment of {own.qualified} has no unit, such as [m] or [-]"


def faults_of_tables(declarations):
    """Messages about entries of INTERFACES and MODELS that the headers do not confirm."""
    interfaces = texts_of_interfaces(declarations)
    members = {own.name for own in declarations if own.parent}
    return [f"{interface}: {what} {name}"
            for interface, entries in (*INTERFACES.items(), *MODELS.items())
            for name in entries
            for what, is_sound in (("does not name", names(interfaces.get(interface, ""), name)),
                                   ("no class has a member", name in members))
            if not is_sound]


def parse(headers, root, flags):
    source = "".join(f"#include <{header.relative_to(root)}>\n" for header in headers)
    return cindex.Index.create().parse(
        "all.cpp", args=["-xc++", "-std=c++20", f"-I{root}", *flags],
        unsaved_files=[("all.cpp", source)],
        options=cindex.TranslationUnit.PARSE_SKIP_FUNCTION_BODIES)


def without(missing, headers, root):
    """The headers, except for those that include this one."""
    lacking = {missing}
    while True:
        further = {header.relative_to(root).as_posix() for header in headers
                   if lacking & set(INCLUDE.findall(header.read_text("utf-8")))} - lacking
        if not further:
            return [each for each in headers if each.relative_to(root).as_posix() not in lacking]
        lacking |= further


def check(repository, flags):
    """Returns the declarations, the headers of other libraries that are missing, and the faults."""
    root = pathlib.Path(repository).resolve() / "include"
    headers = sorted((root / "silt").rglob("*.hpp"))
    missing = []
    while True:
        unit = parse(headers, root, flags)
        errors = [str(each) for each in unit.diagnostics
                  if each.severity >= cindex.Diagnostic.Error]
        not_found = re.search(r"'(.*)' file not found", "\n".join(errors))
        if not not_found:
            break
        missing.append(not_found[1])
        headers = without(missing[-1], headers, root)
    declarations = list(declarations_of(unit, str(root)))
    faults = [f"{own.file}:{own.line}: {message}" for own, message in faults_of(declarations)]
    keys = set(re.findall(r"@\w+\{(\w+),", (root.parent / "docs/references.bib").read_text("utf-8")))
    for header in headers:
        for number, line in enumerate(header.read_text("utf-8").splitlines(), 1):
            faults += [f"{header}:{number}: docs/references.bib has no {key}"
                       for key in SOURCE.findall(line) if key not in keys]
    # Without an optional library, members that only its headers have are not found.
    return declarations, missing, errors + faults + (
        [] if missing else faults_of_tables(declarations))


SOUND = """
#include <compare>
namespace silt {
inline void fail(const char*) {}  ///< Throws.
/// A struct.
struct Good {
  double length;  ///< [m]
  int number;     ///< of things
  /// Throws if it is negative.
  explicit Good(double value) { if (value < 0) fail("no"); }
  Good(const Good&) = default;
  double first() const { return 1; }  ///< [m]
  bool operator==(const Good&) const = default;
 private:
  int hidden;
};
/// An enumeration: `one` or `two`.
enum class Which { one, two };
inline constexpr struct mass_t {} mass{};  ///< m [kg]
/// From a number.
inline void twice(auto number) { number = 2; }
namespace detail { struct Inside { int any; }; }
/// A quotient [-] of [Known2001].
inline double quotient(double a) { return a; }
inline double quotient(float a) { return a; }
/// A class template.
template <class T> class Box {
 public:
  /// Number of things.
  Box(int number);
  /// A class in it.
  class Inner;
};
template <class T> class Box<T*> {};
namespace more {
PLANTED
}
}
"""
FAULTS = {
    "struct NoComment {};": "NoComment has no comment",
    "/// A.\nstruct A { int number; };": "A::number has no comment",
    "/// A.\nstruct A { double x;  ///< along x\n};": "A::x has no unit",
    "/// A.\nstruct A { A(int); };": "A::A has no comment",
    "/// A.\nstruct A { void go(); };": "A::go has no comment",
    "/// A.\nclass A { int x;\n public:\n  int y; };": "A::y has no comment",
    "/// Which.\nenum class Which { yes };": "Which::yes has no comment",
    "/// A kind.\ninline constexpr struct kind_t {} kind{};": "kind has no comment",
    "using Alias = int;": "Alias has no comment",
    "inline constexpr int number = 1;": "number has no comment",
    "template <class T> inline constexpr int number = 1;": "number has no comment",
    "template <class T> concept Any = true;": "Any has no comment",
    "template <class T> void go(T) {}": "go has no comment",
    "inline void go(auto) {}": "go has no comment",
    "// Not for users.\ninline void go() {}": "go has no comment",
    "/// Goes.\ninline void go() { fail(\"no\"); }": "go does not say what is thrown",
    "/// A length.\ninline double go() { return 1; }": "go has no unit",
    "/// After [Unknown2001].\ninline void go() {}": "has no Unknown2001",
    "/// Go.\ninline void go() {": "expected",
}


def self_test():
    """Returns what is wrong."""
    wrong = []
    for text, expected in {"": None, **FAULTS}.items():
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            headers = folder / "include/silt"
            headers.mkdir(parents=True)
            (folder / "docs").mkdir()
            (folder / "docs/references.bib").write_text("@book{Known2001,\n}\n", "utf-8")
            (headers / "missing.hpp").write_text("#include <no_such_library.h>\n", "utf-8")
            (headers / "header.hpp").write_text(SOUND.replace("PLANTED", text), "utf-8")
            missing, faults = check(folder, [])[1:]
            if missing != ["no_such_library.h"]:
                wrong.append(f"a missing header was not found, but {missing}")
            as_expected = len(faults) == 1 and expected in faults[0] if expected else not faults
            if not as_expected:
                wrong.append(f"planted {text!r}, found {faults}")
    return wrong


def use_python_with_clang():
    """Continues with Debian's interpreter if this one lacks clang and that has it; otherwise skips."""
    try:
        cindex.Index.create()
        if hasattr(CursorKind, "CONCEPT_DECL"):
            return
    except (AttributeError, cindex.LibclangError if cindex else AttributeError):
        pass
    has_clang = [SYSTEM_PYTHON, "-c", "from clang import cindex; cindex.Index.create()"]
    if sys.executable != SYSTEM_PYTHON and os.access(SYSTEM_PYTHON, os.X_OK) and subprocess.run(
            has_clang, capture_output=True, check=False).returncode == 0:
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])
    print("skipped: clang's Python module is not installed; Debian's package is python3-clang-19")
    sys.exit(SKIPPED)


def main(arguments):
    counts = arguments[:1] == ["--count"]
    arguments = arguments[counts:]
    if len(arguments) not in {1, 2}:
        sys.exit(__doc__)
    use_python_with_clang()
    if arguments == ["--self-test"]:
        faults = self_test()
    else:
        flags = shlex.split(pathlib.Path(arguments[1]).read_text("utf-8")) if arguments[1:] else []
        # Of a folder of system headers, as of an installed library, clang does not keep comments.
        own = str(pathlib.Path(arguments[0]).resolve() / "include")
        declarations, missing, faults = check(
            arguments[0],
            [each for each in flags if each.startswith(("-I", "-isystem")) and not each.endswith(own)])
        if missing:
            print("left out are headers that need", ", ".join(missing))
        if counts:
            documented = sum(bool(each.comment) for each in declarations)
            print(f"{len(declarations)} public declarations, {documented} with a comment of their own")
    print("\n".join(faults), end="\n" if faults else "")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
