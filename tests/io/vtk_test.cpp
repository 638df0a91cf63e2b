// SPDX-License-Identifier: MIT
#include <silt/core/forces.hpp>
#include <silt/core/simulation.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/io/vtk.hpp>
#include <silt/search/uniform_grid.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <sys/wait.h>

namespace silt::test::vtk_test {
namespace {

inline constexpr struct temperature_t : scalar_field {
} temperature{};
inline constexpr struct colour_t : field_of<std::uint8_t> {
} colour{};
inline constexpr struct label_t : field_of<std::string> {
} label{};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

template <int Dim, class Real>
auto particles() {
  Particles<Dim, Real, velocity_t, force_t, mass_t, spin_t, temperature_t, colour_t, label_t> p;
  for (int k = 0; k < 5; ++k) {
    using Vec = silt::Vec<Dim, Real>;
    const Index i = p.add(Vec(Real(0.25 * k) * Vec::Ones()));
    p[velocity][i] = Real(k) * Vec::Unit(Dim - 1);
    p[mass][i] = 2;
    p[label][i] = "left out";
    p[temperature][i] = Real(300 + k);
    p[colour][i] = static_cast<std::uint8_t>(250 + k);
    if constexpr (Dim == 3) p[spin][i] = Vec::Unit(0);
    if constexpr (Dim == 2) p[spin][i] = 1;
  }
  p.remove(1);
  return p;
}

auto falling() {
  return Simulation{particles<2, double>(), UniformGrid<2>{}, Gravity<2>{{0, -8}}, Leapfrog{}};
}

// The output of read_frame.py; empty if the tool is not installed.
std::string read_with(const std::string& tool, const std::filesystem::path& frame) {
  const auto output = frame.parent_path() / "read.txt";
  const std::string script = SILT_TESTS_DIR "/io/read_frame.py";
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    const std::string command = python + " '" + script + "' " + tool + " '" + frame.string() +
                                "' >'" + output.string() + "' 2>/dev/null";
    const int status = std::system(command.c_str());
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return text_of(output);
    const bool missing =
        WIFEXITED(status) && (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127);
    if (!missing) return tool + " failed to read " + frame.string();
  }
  std::printf("[   note   ] %s is not installed: its reader is not tested\n", tool.c_str());
  return {};
}

template <int Dim, class Real>
void expect_readable_by(const std::string& tool) {
  Folder folder;
  const auto frame = folder.path / "frame.vtu";
  std::ofstream(frame, std::ios::binary) << vtk_frame(particles<Dim, Real>());
  const std::string found = read_with(tool, frame);
  if (found.empty()) return;
  const bool plane = Dim == 2;
  EXPECT_EQ(found, std::string("cells 4\ncolour 1 1009\nforce 3 0 0 0\nid 1 9\nmass 1 8\n") +
                       (plane ? "position 3 2.25 2.25 0\n" : "position 3 2.25 2.25 2.25\n") +
                       (plane ? "spin 1 4\n" : "spin 3 4 0 0\n") + "temperature 1 1209\n" +
                       (plane ? "velocity 3 0 9 0\n" : "velocity 3 0 0 9\n"));
}

TEST(VtkFrame, In2DIsReadByVtk) { expect_readable_by<2, double>("vtk"); }
TEST(VtkFrame, In3DIsReadByVtk) { expect_readable_by<3, float>("vtk"); }
TEST(VtkFrame, In2DIsReadByMeshio) { expect_readable_by<2, float>("meshio"); }
TEST(VtkFrame, In3DIsReadByMeshio) { expect_readable_by<3, double>("meshio"); }

// ParaView 5.11 of Debian 12 does not read a frame that contains raw bytes.
TEST(VtkFrame, IsText) {
  for (const char c : vtk_frame(particles<3, double>())) {
    ASSERT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << int(c);
  }
}

TEST(VtkFrame, HasEveryNumericFieldAndNoOther) {
  const std::string frame = vtk_frame(particles<2, float>());
  for (const char* column :
       {"type=\"Float32\" Name=\"velocity\" NumberOfComponents=\"3\"",
        "type=\"Float32\" Name=\"temperature\" NumberOfComponents=\"1\"",
        "type=\"UInt8\" Name=\"colour\" NumberOfComponents=\"1\"",
        "type=\"UInt64\" Name=\"id\" NumberOfComponents=\"1\""}) {
    EXPECT_NE(frame.find(column), std::string::npos) << column;
  }
  EXPECT_EQ(frame.find("label"), std::string::npos);
}

TEST(VtkFrame, MayBeEmpty) {
  const std::string frame = vtk_frame(Particles<3, double, velocity_t>{});
  EXPECT_NE(frame.find("NumberOfPoints=\"0\""), std::string::npos);
}

TEST(VtkFrame, IsBitwiseIdenticalForTheSameParticles) {
  EXPECT_EQ(vtk_frame(particles<3, double>()), vtk_frame(particles<3, double>()));
}

TEST(VtkSeries, ListsEveryFrameWithItsTimeIncludingTheInitialState) {
  Folder folder;
  auto simulation = falling();
  VtkSeries series{folder.path / "deep" / "fall"};
  simulation.run({.until = 0.5, .output_every = 0.25, .time_step = 0.125}, series);
  EXPECT_EQ(series.frames(), 3u);
  EXPECT_EQ(text_of(folder.path / "deep" / "fall.pvd"),
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n"
            "<DataSet timestep=\"0\" file=\"fall/fall_000000.vtu\"/>\n"
            "<DataSet timestep=\"0.25\" file=\"fall/fall_000001.vtu\"/>\n"
            "<DataSet timestep=\"0.5\" file=\"fall/fall_000002.vtu\"/>\n"
            "</Collection>\n</VTKFile>\n");
  EXPECT_EQ(text_of(folder.path / "deep/fall/fall_000002.vtu"), vtk_frame(simulation.snapshot()));
}

TEST(VtkSeries, LeavesNoPartialFiles) {
  Folder folder;
  auto simulation = falling();
  simulation.run({.until = 0.25, .time_step = 0.125}, VtkSeries{folder.path / "fall"});
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path)) {
    EXPECT_NE(entry.path().extension(), ".part");
  }
}

TEST(VtkSeries, ReportsWhyAFolderCannotBeCreated) {
  Folder folder;
  std::ofstream(folder.path / "file") << "in the way";
  const auto below = folder.path / "file" / "frames";
  EXPECT_TRUE(test::refuses([&] { VtkSeries series{below}; },
                            {"VtkSeries", below.string(), "Not a directory"}));
  EXPECT_TRUE(test::refuses([&] { VtkSeries series{folder.path / "file"}; },
                            {"VtkSeries", "a file with this name exists"}));
}

TEST(VtkSeries, ReportsWhyAFileCannotBeWritten) {
  Folder folder;
  auto simulation = falling();
  VtkSeries series{folder.path / "frames"};
  std::filesystem::remove_all(folder.path / "frames");
  EXPECT_TRUE(test::refuses([&] { series(simulation); },
                            {"VtkSeries", "frames_000000.vtu", "No such file or directory"}));
}

}  // namespace
}  // namespace silt::test::vtk_test
