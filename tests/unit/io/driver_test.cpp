// SPDX-License-Identifier: Apache-2.0
#include "examples/common/driver.hpp"

#include <csignal>
#include <new>

#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/scheme_flags.hpp"
#include "io/build_info.hpp"
#include "io/mapped_file.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

/// A driver with one option of each kind, run with `arguments`.
struct SampleDriver {
  double mu = 0.3;
  int steps = 10;
  std::uint64_t seed = 7;
  std::string mode = "dynamic";
  std::filesystem::path mesh{};
  CommonOptions common{};
  Cli cli{"sample", "Does nothing, with care."};
  std::function<ExitCode()> body = [] { return ExitCode::ok; };
  bool ran = false;
  std::string out{}, err{};

  SampleDriver() {
    cli.group("scene");
    cli.option("--mu", mu, "friction coefficient", "-", {0, 10});
    cli.input("--mesh", mesh, "surface of the part");
    cli.choice("--mode", mode, "what is computed", {"dynamic", "kinematic"});
    cli.group("stepping");
    cli.option("--steps", steps, "steps", "", {1, 1e6});
    cli.option("--seed", seed, "of the random numbers");
    cli.option("--json", common.summary, "the same as --summary");
    cli.common(common);
    cli.example("sample --mu 0.2", "little friction");
    cli.example("sample --steps 3 --quiet", "a short run");
  }
  int run(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "build/sample");
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = run_driver(cli, int(arguments.size()), arguments.data(), [this] {
      ran = true;
      return body();
    });
    out = ::testing::internal::GetCapturedStdout();
    err = ::testing::internal::GetCapturedStderr();
    return code;
  }
  template <class Error>
  int run_throwing(const Error& error) {
    body = [&error]() -> ExitCode { throw error; };
    return run({});
  }
};

// A file of two pages that permits no writing, mapped, and what happens to it while a driver runs.
struct MappedInput {
  std::filesystem::path path = fresh_folder() / "input";
  FileBytes bytes{};
  MappedInput() {
    write_bytes(path, std::string(8192, 'x'));
    forbid_writing(path);
    bytes = bytes_of_file(path);
    std::filesystem::permissions(path, std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::add);
  }
};

}  // namespace

TEST(Driver, NamesTheFlagsOfTheMembersThatDoNotGoTogether) {
  SampleDriver driver;
  SchemeFlags flags;
  add_options(driver.cli, flags);
  const SchemeOptions options{.step = {.h = 1e-8, .advancement = {.min_h = 1e-5}}};
  std::string message;
  driver.body = [&]() -> ExitCode {
    try {
      validate(options.step);
    } catch (const std::invalid_argument& error) {
      message = error.what();
      throw;
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(driver.run({}), 2);
  EXPECT_TRUE(message.starts_with("AdvancementOptions::min_h = 1e-05 must")) << message;
  EXPECT_EQ(driver.err, "sample: --min-h" + message.substr(message.find(" = ")) + "\n");
  EXPECT_EQ(driver.cli.said_with_flags("MoreauJeanProjectedOptions::theta and MoreauJeanOptions::theta"),
            "--theta and --theta");
  for (const char* other : {"AdvancementOptions::min_here", "MyAdvancementOptions::min_h", "min_h", ""})
    EXPECT_EQ(driver.cli.said_with_flags(other), other);
}

TEST(Driver, RefusesFlagsThatSolverReducerAndClusteringDoNotRead) {
  const auto refusal = [](std::vector<const char*> said) {
    SampleDriver driver;
    SchemeFlags flags;
    flags.left_out.push_back("--relaxation");
    add_options(driver.cli, flags);
    driver.body = [&] { return refuse_unread_flags(driver.cli, flags), ExitCode::ok; };
    return driver.run(std::move(said)) == 0 ? "" : driver.err;
  };
  EXPECT_EQ(refusal({"--solver", "admm", "--anderson", "3"}), "");
  EXPECT_EQ(refusal({"--prox", "blocks"}),  // the default, and yet it was said
            "sample: --prox has no effect with --solver auto, only for --solver sor_prox, jor_prox\n");
  EXPECT_EQ(refusal({"--reducer", "none", "--min-margin", "0.5"}),
            "sample: --min-margin has no effect with --reducer none\n");
  EXPECT_EQ(refusal({"--clusters", "2"}), "sample: --clusters has no effect with --clustering angle\n");
  EXPECT_EQ(refusal({"--clusters", "2", "--clustering", "kmc"}), "");
  EXPECT_EQ(refusal({"--solver", "interior_point"}), "") << "nor is a flag that is not offered asked for";
}

TEST(Driver, FillsTheValuesAndRunsTheBody) {
  SampleDriver driver;
  EXPECT_EQ(driver.run({"--mu", "0.25", "--steps=3", "--mode", "kinematic", "-o", "there", "--quiet",
                        "--seed", "18446744073709551615"}),
            0);
  EXPECT_TRUE(driver.ran);
  EXPECT_EQ(driver.mu, 0.25);
  EXPECT_EQ(driver.steps, 3);
  EXPECT_EQ(driver.mode, "kinematic");
  EXPECT_EQ(driver.seed, 18446744073709551615u);
  EXPECT_EQ(driver.common.out, "there");
  EXPECT_TRUE(driver.common.quiet);
  EXPECT_FALSE(driver.common.resume);
  EXPECT_EQ(driver.out + driver.err, "");
}

TEST(Driver, TakesWordsBetweenBlanksOrCommasOrOneByOne) {
  const std::vector<std::vector<const char*>> lines{{"sample", "--case", "A", "B", "C (d, e)"},
                                                    {"sample", "--case", "A,B", "--case", "C (d, e)"},
                                                    {"sample", "--case=A, B ,,C (d, e),"}};
  for (const auto& line : lines) {
    Cli cli("sample", "Does nothing.");
    std::vector<std::string> words;
    cli.option("--case", words, "what moves");
    ExitCode code = ExitCode::usage;
    ASSERT_TRUE(cli.parse(int(line.size()), line.data(), code));
    EXPECT_EQ(words, (std::vector<std::string>{"A", "B", "C (d, e)"}));
    EXPECT_EQ(cli.values(), "--case A B C (d, e)\n");
  }
}

TEST(ManyTasks, FilesAreNamedByLettersThatAnyFolderTakes) {
  EXPECT_EQ(file_stem("A5.paper_6 rods, spherical"), "A5.paper_6_rods__spherical");
  EXPECT_EQ(file_stem("ball_e05_moreau_jean theta 0.5"), "ball_e05_moreau_jean_theta_0.5");
}

TEST(Driver, TwoNamesOfOneThingAreNotGivenTogether) {
  for (const char* name : {"--json", "--summary"}) {
    SampleDriver driver;
    EXPECT_EQ(driver.run({name, "a.json"}), 0);
    EXPECT_EQ(driver.common.summary, "a.json");
  }
  SampleDriver driver;
  EXPECT_EQ(driver.run({"--json", "a.json", "--summary", "b.json"}), 2);
  EXPECT_NE(driver.err.find("--json"), std::string::npos) << driver.err;
  EXPECT_NE(driver.err.find("--summary"), std::string::npos) << driver.err;
  EXPECT_FALSE(driver.ran);
}

TEST(Driver, ResumeAnywayIsAWayToResume) {
  CommonOptions common;
  Cli cli("sample", "Stops and goes on.");
  cli.common(common, Cli::Restart::yes);
  const char* words[] = {"sample", "--resume-anyway"};
  ExitCode code = ExitCode::usage;
  EXPECT_TRUE(cli.parse(2, words, code));
  EXPECT_TRUE(common.resume && common.resume_anyway);
  EXPECT_NE(cli.help().find("also from a checkpoint of another build"), std::string::npos);
}

TEST(Driver, HelpNamesDefaultUnitRangeAndExamples) {
  SampleDriver driver;
  EXPECT_EQ(driver.run({"--help"}), 0);
  EXPECT_FALSE(driver.ran);
  for (const char* piece : {"usage: sample [options]", "friction coefficient [-], in [0, 10], default 0.3",
                            "\nstepping\n", "one of dynamic, kinematic, default dynamic", "\noutput\n",
                            "sample --mu 0.2\n      little friction", "130 interrupted"})
    EXPECT_NE(driver.out.find(piece), std::string::npos) << piece << "\n" << driver.out;
}

TEST(Driver, VersionNamesLibrariesFlagsAndLicence) {
  SampleDriver driver;
  EXPECT_EQ(driver.run({"--version"}), 0);
  for (const char* piece :
       {"aussois 0.", "Eigen 3.", "HDF5 1.", "CGAL 5.", "licence of this binary: Apache-2.0", "++ "})
    EXPECT_NE(driver.out.find(piece), std::string::npos) << piece << "\n" << driver.out;
}

TEST(Driver, RefusesWhatIsNotAllowedWithOneLineThatNamesIt) {
  const std::vector<std::pair<std::vector<const char*>, std::string>> cases = {
      {{"--mu", "11"}, "--mu"},       {{"--mu", "nan"}, "--mu"},
      {{"--mu", "much"}, "--mu"},     {{"--mu"}, "--mu"},
      {{"--steps", "0"}, "--steps"},  {{"--steps", "2.5"}, "--steps"},
      {{"--seed", "-1"}, "--seed"},   {{"--mode", "fast"}, "one of dynamic, kinematic"},
      {{"--nonsense"}, "--nonsense"}, {{"stray"}, "stray"},
  };
  for (const auto& [arguments, named] : cases) {
    SampleDriver driver;
    EXPECT_EQ(driver.run(arguments), 2) << arguments[0];
    EXPECT_FALSE(driver.ran);
    EXPECT_NE(driver.err.find(named), std::string::npos) << driver.err;
    EXPECT_EQ(std::count(driver.err.begin(), driver.err.end(), '\n'), 1) << driver.err;
  }
  SampleDriver driver;
  driver.run({"--mu", "11"});
  EXPECT_EQ(driver.err, "sample: --mu: 11 must be in [0, 10] (try --help)\n");
}

TEST(Driver, RefusesAnInputThatIsNotThere) {
  SampleDriver driver;
  EXPECT_EQ(driver.run({"--mesh", "no/such.obj"}), 3);
  EXPECT_EQ(driver.err, "sample: --mesh no/such.obj: no such file or folder\n");
  EXPECT_FALSE(driver.ran);
}

TEST(Driver, TurnsWhatIsThrownIntoAnExitCodeAndOneLine) {
  SampleDriver driver;
  EXPECT_EQ(driver.run_throwing(std::invalid_argument("mu = -1 must be >= 0")), 2);
  EXPECT_EQ(driver.err, "sample: mu = -1 must be >= 0\n");
  EXPECT_EQ(driver.run_throwing(std::runtime_error("a.obj:3: bad")), 3);
  EXPECT_EQ(driver.err, "sample: a.obj:3: bad\n");
  EXPECT_EQ(driver.run_throwing(NumericalFailure("not finite at t = 1 s")), 4);
  EXPECT_EQ(driver.run_throwing(std::bad_alloc()), 4);
  driver.body = [] { return ExitCode::not_accepted; };
  EXPECT_EQ(driver.run({}), 1);
}

TEST(Driver, SeesTheFirstSignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    SampleDriver driver;
    driver.body = [signal] {
      EXPECT_FALSE(interrupted());
      std::raise(signal);
      return interrupted() ? ExitCode::interrupted : ExitCode::ok;
    };
    EXPECT_EQ(driver.run({}), 130);
  }
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

TEST(DriverDeathTest, NamesAMappedFileThatIsCutOff) {
  SampleDriver driver;
  driver.body = [] {
    const MappedInput input;
    std::filesystem::resize_file(input.path, 1);
    return input.bytes.bytes.back() == std::byte('x') ? ExitCode::ok : ExitCode::not_accepted;
  };
  const char* const arguments[] = {"sample"};
  EXPECT_EXIT(std::exit(run_driver(driver.cli, 1, arguments, driver.body)), ::testing::ExitedWithCode(3),
              "^sample: .*input: was cut off while it was in use\n$");
}

TEST(DriverDeathTest, IsKilledByABusErrorOfAnotherKind) {
  SampleDriver driver;
  driver.body = []() -> ExitCode {
    std::raise(SIGBUS);
    return std::raise(SIGBUS), ExitCode::ok;
  };
  const char* const arguments[] = {"sample"};
  EXPECT_EXIT(run_driver(driver.cli, 1, arguments, driver.body), ::testing::KilledBySignal(SIGBUS), "");
}

TEST(Driver, NamesAMappedFileThatIsWritten) {
  SampleDriver driver;
  driver.body = [] {
    const MappedInput input;
    write_bytes(input.path, "short");
    return ExitCode::ok;
  };
  EXPECT_EQ(driver.run({}), 3);
  EXPECT_NE(driver.err.find("input: was written while it was in use; results may be wrong\n"),
            std::string::npos)
      << driver.err;
}

TEST(Driver, ValuesTellRunsApart) {
  SampleDriver a, b;
  EXPECT_EQ(a.cli.values(), b.cli.values());
  b.run({"--mu", "0.30000000000000004"});
  EXPECT_NE(a.cli.values(), b.cli.values());
  EXPECT_EQ(a.cli.values().substr(0, a.cli.values().find('\n')), "--mu 0.3");
  EXPECT_EQ(a.cli.values("stepping").substr(0, 8), "--steps ");
  EXPECT_EQ(b.cli.given("scene"), (std::vector<std::string>{"--mu"}));
  EXPECT_TRUE(b.cli.given("stepping").empty());
}

TEST(Driver, WritesTheCommandLineAsOneWouldTypeIt) {
  const char* const argv[] = {"/usr/bin/drop part", "--out", "my folder", "it's", "-x=1", ""};
  EXPECT_EQ(command_line(6, argv), "'drop part' --out 'my folder' 'it'\\''s' -x=1 ''");
}

TEST(Progress, EstimatesTheTimeLeftFromTheRate) {
  const Progress progress("drop", 20, Progress::Style::none);
  EXPECT_EQ(progress.line(0, 0, ""), "drop    0 %");
  EXPECT_EQ(progress.line(5, 25, "7 contacts"), "drop   25 %  1 min 15 s left  7 contacts");
  EXPECT_EQ(progress.line(20, 3700, ""), "drop  100 %  1 h 01 min");
  EXPECT_EQ(duration_text(59.4), "59 s");
}

TEST(Progress, InALogOfAShortRunIsNothing) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("drop", 1000, Progress::Style::log);
    for (int k = 0; k <= 1000; ++k) progress.at(k);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, InALogIsALineAfterTenSecondsAndOneWithEachDoubling) {
  Progress progress("drop", 7200, Progress::Style::log);
  std::vector<int> lines;
  for (int second = 0; second <= 7200; ++second)  // two hours
    if (progress.due_in_log(second, second)) lines.push_back(second);
  EXPECT_EQ(lines, (std::vector<int>{10, 20, 40, 80, 160, 320, 640, 1280, 2560, 5120, 7200}));
  EXPECT_EQ(progress.line(lines[0], lines[0], ""), "drop    0 %  1 h 59 min left");
}

TEST(Progress, OnATerminalRewritesOneLineAtMostTenTimesASecond) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("drop", 1e6, Progress::Style::terminal);
    for (int k = 0; k <= 100000; ++k) progress.at(10 * k);
  }
  const std::string shown = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(shown.begin(), shown.end(), '\n'), 1);
  EXPECT_LT(std::count(shown.begin(), shown.end(), '\r'),
            30);  // 0.1 s apart; the loop takes far less than 3 s
  EXPECT_NE(shown.find("\rdrop  100 %"), std::string::npos);
}

TEST(Progress, CanBeSilent) {
  ::testing::internal::CaptureStderr();
  Progress(std::string("drop"), 1, Progress::style_of_stderr(true)).at(1);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(SchemeFlags, HaveOneDefaultForAllOptionsOfAFlag) {
  SchemeFlags one;
  start_from_theta(one.options, 0.7);
  Cli cli("program", "A program.");
  add_options(cli, one);
  EXPECT_EQ(scheme_options(one).moreau_jean.theta, 0.7);
  EXPECT_EQ(scheme_options(one).moreau_jean_projected.theta, 0.7);
  SchemeFlags two;
  two.options.moreau_jean.theta = 1;
  Cli other("program", "A program.");
  EXPECT_EQ(message_of<std::logic_error>([&] { add_options(other, two); }),
            "--theta: moreau_jean.theta = 1 and moreau_jean_projected.theta = 0.5 share the flag");
}

// The flags of a part with what the user said; those that the driver does not name are not offered.
TEST(SettingFlags, AreAddedInTheOrderOfTheDriver) {
  SolverOptions solver{.max_iterations = 7};
  SaidSettings said;
  Cli cli("program", "A program.");
  add_flags(cli, solver, said, {"--tolerance", "--max-iterations"});
  EXPECT_EQ(cli.values(), "--tolerance 1e-08\n--max-iterations 7\n");
  const char* arguments[] = {"program", "--tolerance", "1e-4"};
  ExitCode code = ExitCode::ok;
  ASSERT_TRUE(cli.parse(3, arguments, code));
  take(said, solver);
  EXPECT_EQ(solver.tolerance, 1e-4);
  EXPECT_EQ(solver.max_iterations, 7);
  EXPECT_EQ(message_of<std::logic_error>([&] { add_flags(cli, solver, said, {"--mu"}); }),
            "--mu is not offered");
}

TEST(Driver, TakesFilesWithoutAFlagAnywhere) {
  Cli cli("many", "Takes files.");
  std::vector<std::filesystem::path> files;
  double mu = 0;
  cli.files(files, "HDF5 files");
  cli.option("--mu", mu, "friction coefficient", "-", {0, 10});
  const auto parse = [&](std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "many");
    ExitCode code = ExitCode::ok;
    ::testing::internal::CaptureStderr();
    cli.parse(int(arguments.size()), arguments.data(), code);
    return std::pair(code, ::testing::internal::GetCapturedStderr());
  };
  EXPECT_EQ(parse({"a.hdf5", "--mu", "0.5", "b.hdf5"}).first, ExitCode::ok);
  EXPECT_EQ(files, (std::vector<std::filesystem::path>{"a.hdf5", "b.hdf5"}));
  EXPECT_EQ(mu, 0.5);
  EXPECT_NE(cli.values().find("FILE a.hdf5 b.hdf5\n"), std::string::npos);
  EXPECT_NE(cli.help().find("usage: many [options] FILE...\n"), std::string::npos);
}

TEST(Driver, WantsAFileWhereFilesAreTaken) {
  Cli cli("many", "Takes files.");
  std::vector<std::filesystem::path> files;
  cli.files(files, "HDF5 files");
  const char* arguments[] = {"many"};
  ExitCode code = ExitCode::ok;
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(cli.parse(1, arguments, code));
  EXPECT_EQ(code, ExitCode::usage);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "many: give at least one FILE (try --help)\n");
}

}  // namespace aussois
