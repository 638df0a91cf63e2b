// SPDX-License-Identifier: MIT
// Fuzz target: any bytes as a CSV file, and grains from the table that is read.
#include <silt/core/fields.hpp>
#include <silt/dem/setup/grain_table.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/particle_csv.hpp>

#include "fuzz/target.hpp"
#include "support/check.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace {

using namespace silt;

template <int Dim, class Real>
void use_as_grains(const CsvTable& table, const fuzz::InputFile& file) {
  dem::Grains<Dim, Real> grains;
  const dem::Grain defaults{.radius = 0.01, .density = 2500};
  if (!fuzz::accepts([&] { grains = dem::grains_from<Dim, Real>(table, defaults); })) return;
  fuzz::require(grains.size() == table.rows(), "another number of grains than of rows");
  for (Index i = 0; i < grains.size(); ++i) {
    fuzz::require(is_finite(grains[position][i]) && is_finite(grains[velocity][i]),
                  "a grain whose motion is not finite");
    for (const Real value : {grains[radius][i], grains[mass][i], grains[inertia][i]}) {
      fuzz::require(is_finite(value) && value > 0,
                    "a grain whose radius, mass or inertia is not positive and finite");
    }
  }
  write_csv(file.path(), grains);
  const auto again = dem::grains_from<Dim, Real>(read_csv(file.path()));
  fuzz::require(test::state_of(again) == test::state_of(grains), "other grains are read back");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file;
  file.write(fuzz::as_text(data, size));
  std::optional<CsvTable> table;
  // A value of two bytes takes a number and a line number, in vectors that double their capacity.
  fuzz::require_memory(64, size, [&] { fuzz::accepts([&] { table = read_csv(file.path()); }); });
  if (!table) return 0;
  use_as_grains<2, double>(*table, file);
  use_as_grains<3, float>(*table, file);
  return 0;
}
