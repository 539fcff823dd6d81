// SPDX-License-Identifier: GPL-3.0-or-later
// What stands on disk is whole, whatever happens to the program; what it cannot do it says.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "exporters/bundle.hpp"
#include "generator/adapters/itk_io.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;

class NothingLost : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = testing::scratch_folder(std::string("nothing_lost_") +
                                     ::testing::UnitTest::GetInstance()->current_test_info()->name());
    Grid grid;
    grid.size = {64, 64, 64};
    grid.spacing_mm = {2, 2, 2};
    CtVolume ct(grid);
    for (std::size_t v = 0; v < ct.voxels.size(); ++v) ct.voxels[v] = static_cast<std::int16_t>(v * 2654435761U >> 22);
    adapters::write_volume((folder / "ct.nii.gz").string(), ct);
  }

  testing::ProgramResult heartgen(const std::string& arguments, const std::string& launcher = "") const {
    return testing::heartgen(arguments, folder.string(), launcher);
  }

  /// A bundle without a build.
  void write_bundle(const std::string& name) const {
    exporters::Bundle bundle;
    bundle.name = "small";
    bundle.version = "1.0.0";
    bundle.recipe = "name = \"small\"\n";
    bundle.meshes["myocardium"] = testing::two_region_mesh(2);
    exporters::write_bundle(bundle, folder / name);
  }

  /// Everything below the folder but the two streams of the runs.
  std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (!entry.path().filename().string().starts_with("std"))
        names.push_back(entry.path().lexically_relative(folder));
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder;
};

// ---- several writers ----

TEST_F(NothingLost, OfTwoWritersOneWinsWholeAndNoneIsMixed) {
  for (const char* iterations : {"1", "2"})
    ASSERT_EQ(
        heartgen(std::string("filter heat ct.nii.gz r") + iterations + ".nii.gz --iterations " + iterations).exit_code,
        0);
  ASSERT_NE(bytes_of(folder / "r1.nii.gz"), bytes_of(folder / "r2.nii.gz"));
  for (int repeat = 0; repeat < 6; ++repeat) {
    const auto writer = [&](const std::string& iterations, testing::ProgramResult& result) {
      const auto own = folder / ("of" + iterations);
      fs::create_directory(own);
      result = testing::heartgen("filter heat ../ct.nii.gz ../t.nii.gz --iterations " + iterations, own.string());
    };
    testing::ProgramResult first, second;
    std::thread beside([&] { writer("1", first); });
    writer("2", second);
    beside.join();
    const auto found = bytes_of(folder / "t.nii.gz");
    EXPECT_TRUE(found == bytes_of(folder / "r1.nii.gz") || found == bytes_of(folder / "r2.nii.gz"));
    EXPECT_TRUE(first.exit_code == 0 || second.exit_code == 0);
    for (const auto* result : {&first, &second}) {
      const bool says_so = result->errors.find("another run is writing this file") != std::string::npos;
      EXPECT_TRUE(result->exit_code == 0 || says_so) << result->errors;
    }
    fs::remove(folder / "t.nii.gz");
  }
}

// ---- standard output ----

TEST_F(NothingLost, AStandardOutputThatCannotBeWrittenIsAnError) {
  write_bundle("B");
  for (const char* command : {"info B --json", "verify B", "--help", "--version", "export B --to stl --output x"})
    for (const char* where : {" >/dev/full", " >&-"}) {
      // The inner redirection holds: testing::heartgen's own stands before it.
      const std::string run = std::string("cd ") + folder.string() + " && " + HEARTGEN_PROGRAM + " " + command + where +
                              " 2>err.txt </dev/null";
      const int status = std::system(run.c_str());
      EXPECT_EQ(WEXITSTATUS(status), 2) << run;
      EXPECT_NE(bytes_of(folder / "err.txt").find("heartgen: standard output: cannot be written"), std::string::npos)
          << run << "\n"
          << bytes_of(folder / "err.txt");
    }
  EXPECT_FALSE(fs::is_empty(folder / "x")) << "the files themselves are written";
}

TEST_F(NothingLost, AClosedStreamIsNoFileOfOurs) {
  const std::string run = std::string("cd ") + folder.string() + " && " + HEARTGEN_PROGRAM;
  EXPECT_EQ(std::system((run + " filter heat ct.nii.gz a.nii.gz --iterations 1 <&- >&- 2>&-").c_str()), 0);
  EXPECT_EQ(heartgen("filter heat ct.nii.gz b.nii.gz --iterations 1").exit_code, 0);
  EXPECT_EQ(bytes_of(folder / "a.nii.gz"), bytes_of(folder / "b.nii.gz"));
}

TEST_F(NothingLost, AReaderThatHasEnoughEndsTheProgramAsUsual) {
  write_bundle("B");
  const std::string run = std::string("cd ") + folder.string() + " && bash -c '" + HEARTGEN_PROGRAM +
                          " info B 2>err.txt | true; sleep 0; exit ${PIPESTATUS[0]}'";
  const int code = WEXITSTATUS(std::system(run.c_str()));
  EXPECT_TRUE(code == 128 + SIGPIPE || code == 0) << code;
  EXPECT_EQ(bytes_of(folder / "err.txt"), "");
}

TEST_F(NothingLost, AFullStandardErrorStopsNothing) {
  const std::string run = std::string("cd ") + folder.string() + " && " + HEARTGEN_PROGRAM;
  EXPECT_EQ(WEXITSTATUS(std::system((run + " info none 2>/dev/full").c_str())), 2);
}

// ---- signals ----

/// Starts the program, sends the signal once `sign` is there, and returns the exit code.
int stopped_by(int number, const fs::path& folder, const std::vector<std::string>& arguments, const fs::path& sign) {
  const pid_t child = fork();
  if (child == 0) {
    std::vector<char*> words;
    std::string program = HEARTGEN_PROGRAM;
    words.push_back(program.data());
    auto copies = arguments;
    for (auto& word : copies) words.push_back(word.data());
    words.push_back(nullptr);
    const int err = open((folder / "stderr.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    signal(number, SIG_DFL);  // the tests themselves may run under nohup
    if (chdir(folder.c_str()) != 0 || dup2(err, STDERR_FILENO) < 0) _exit(99);
    execv(words[0], words.data());
    _exit(99);
  }
  constexpr int max_polls = 6000;
  for (int poll = 0; poll < max_polls && !fs::exists(sign); ++poll)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(fs::exists(sign));
  kill(child, number);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(NothingLost, ASignalEndsABuildWithOneLineAndNothingLeft) {
  ASSERT_EQ(heartgen("phantom ph --size 64,64,48 --spacing 5.4,5.4,6.3").exit_code, 0);
  const auto before = entries();
  for (const auto& [number, code, name] :
       {std::tuple{SIGINT, 130, "SIGINT"}, {SIGTERM, 143, "SIGTERM"}, {SIGHUP, 129, "SIGHUP"}}) {
    EXPECT_EQ(stopped_by(number, folder, {"build", "ph/recipe.toml", "--output", "W", "--quiet", "--no-cache"},
                         folder / ".W.partial"),
              code);
    const auto said = bytes_of(folder / "stderr.txt");
    EXPECT_NE(said.find(std::string("heartgen: stopped by ") + name), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    EXPECT_EQ(entries(), before);
  }
}

TEST_F(NothingLost, AnIgnoredSignalStaysIgnored) {
  const auto run = heartgen("filter heat ct.nii.gz a.nii.gz --iterations 200 & p=$!; sleep 0.3; kill -INT $p; wait $p",
                            "trap '' INT;");
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_TRUE(fs::exists(folder / "a.nii.gz"));
}

// ---- older outputs ----

TEST_F(NothingLost, APhantomIsNotWrittenOverAUsersScan) {
  const auto before = bytes_of(folder / "ct.nii.gz");
  const auto run = heartgen("phantom . --size 32,32,24 --spacing 10.8,10.8,12.6");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.errors,
            "heartgen: ./ct.nii.gz: exists, and is not as this command writes it (name another folder, or "
            "move it away)\n");
  EXPECT_EQ(bytes_of(folder / "ct.nii.gz"), before);
  EXPECT_FALSE(fs::exists(folder / "recipe.toml"));
}

TEST_F(NothingLost, AnOlderHeaderAndItsVoxelsStayWhereTheNewDoNotFit) {
  ASSERT_EQ(heartgen("filter heat ct.nii.gz o.mhd --iterations 1").exit_code, 0);
  const auto header = bytes_of(folder / "o.mhd"), voxels = bytes_of(folder / "o.zraw");
  EXPECT_NE(header.find("ElementDataFile = o.zraw\n"), std::string::npos) << header;
  const auto before = entries();
  const auto full = heartgen("filter perona_malik ct.nii.gz o.mhd --iterations 3", "ulimit -c 0; ulimit -f 100;");
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_TRUE(full.errors.starts_with("heartgen: o.mhd: cannot be written")) << full.errors;
  EXPECT_EQ(std::count(full.errors.begin(), full.errors.end(), '\n'), 1) << full.errors;
  EXPECT_EQ(bytes_of(folder / "o.mhd"), header);
  EXPECT_EQ(bytes_of(folder / "o.zraw"), voxels);
  EXPECT_EQ(entries(), before);
  // In place.
  ASSERT_EQ(heartgen("filter heat o.mhd o.mhd --iterations 1").exit_code, 0);
  EXPECT_NE(bytes_of(folder / "o.zraw"), voxels);
  EXPECT_EQ(entries(), before);
  EXPECT_EQ(heartgen("filter heat o.mhd q.nii --iterations 1").exit_code, 0);
}

TEST_F(NothingLost, ABuildDoesNotReplaceAFolderWithFilesOfTheUser) {
  write_bundle("W");
  fs::create_directory(folder / "W" / "my_simulation");
  testing::write_bytes(folder / "W" / "my_simulation" / "results.dat", "important");
  std::ofstream(folder / "recipe.toml") << "[input]\nct = \"ct.nii.gz\"\n";
  const auto before = entries();
  const auto run = heartgen("build recipe.toml --output W --force --quiet");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.errors.find("W: holds files that are not in its manifest: my_simulation/results.dat"),
            std::string::npos)
      << run.errors;
  EXPECT_EQ(entries(), before);
}

TEST_F(NothingLost, ARefusedBuildLeavesNothing) {
  std::ofstream(folder / "recipe.toml") << "[input]\nct = \"ct.nii.gz\"\n";
  const auto before = entries();
  const auto run = heartgen("build recipe.toml --output deep/er/W --quiet");
  EXPECT_EQ(run.exit_code, 2) << run.errors;
  EXPECT_EQ(entries(), before) << run.errors;
}

// ---- nothing let in ----

TEST_F(NothingLost, PipesAndDevicesAreRefusedAsInput) {
  write_bundle("B");
  for (const char* name :
       {"p.nii.gz", "p.nrrd", "p.mha", "p.toml", "p.vtu", "p.vtk", "p.msh", "p.json", "p.tar.zst", "series/1.dcm"}) {
    fs::create_directories((folder / name).parent_path());
    ASSERT_EQ(mkfifo((folder / name).c_str(), 0600), 0) << name;
  }
  std::ofstream(folder / "p.mhd") << "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementSpacing = 1 1 1\n"
                                     "ElementType = MET_SHORT\nElementDataFile = p.nrrd\n";
  std::ofstream(folder / "q.nrrd") << "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
                                      "endian: little\ndata file: p.mha\n\n";
  for (const char* command :
       {"filter heat p.nii.gz o.nii", "filter heat p.nrrd o.nii", "filter heat p.mha o.nii", "filter heat p.mhd o.nii",
        "filter heat q.nrrd o.nii", "filter heat series o.nii", "mesh p.nii.gz o.vtu", "mesh p.nrrd o.vtu",
        "build p.toml --output o", "improve p.vtu o.vtu", "improve p.vtk o.vtu", "improve p.msh o.vtu",
        "segment p.toml ct.nii.gz o.nii", "unpack p.tar.zst o"}) {
    const auto run = heartgen(command, "timeout 60");
    EXPECT_EQ(run.exit_code, 2) << command << "\n" << run.errors;
    EXPECT_NE(run.errors.find("is a pipe or a device"), std::string::npos) << command << "\n" << run.errors;
  }
}

TEST_F(NothingLost, WhatMayNotBeReadIsSaidSo) {
  if (geteuid() != 0) GTEST_SKIP() << "needs the right to become another user";
  fs::permissions(folder, fs::perms::all);
  write_bundle("B");
  for (const char* name : {"u.nii.gz", "u.nrrd", "u.mha", "u.vtu", "u.msh", "u.toml", "u.tar.zst", "u.seg.nrrd"}) {
    testing::write_bytes(folder / name, "x");
    fs::permissions(folder / name, fs::perms::none);
  }
  for (const char* command : {"filter heat u.nii.gz o.nii", "filter heat u.nrrd o.nii", "filter heat u.mha o.nii",
                              "mesh u.nii.gz o.vtu", "mesh u.seg.nrrd o.vtu", "improve u.vtu o.vtu",
                              "improve u.msh o.vtu", "build u.toml --output o", "unpack u.tar.zst o"}) {
    const auto run = heartgen(command, "setpriv --reuid=65534 --regid=65534 --clear-groups");
    EXPECT_EQ(run.exit_code, 2) << command << "\n" << run.errors;
    EXPECT_NE(run.errors.find("no right to read it"), std::string::npos) << command << "\n" << run.errors;
  }
}

TEST_F(NothingLost, NoFileNameSteersTheTerminal) {
  write_bundle("B");
  const std::string name = "$'\\e[31mred\\nheartgen: fine'";
  for (const std::string command : {"info ", "verify ", "filter heat ", "improve ", "--"}) {
    const auto run =
        heartgen("B; bash -c \"" + std::string(HEARTGEN_PROGRAM) + " " + command + name + " o.nii\"", "true");
    EXPECT_EQ(run.exit_code, 2) << command;
    EXPECT_EQ((run.output + run.errors).find('\x1b'), std::string::npos) << command;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
  }
  testing::write_bytes(folder / "B" / "\x1b[2J", "x");
  const auto run = heartgen("verify B");
  EXPECT_NE(run.output.find("?[2J: is not in the manifest"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace heartgen
