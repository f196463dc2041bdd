// What the program says to words that it does not understand, and about itself.
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program.h"
#include <algorithm>

namespace patina {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct WrongWords {
    const char* name;
    std::string arguments;
    std::string message;  // part of it
};

class ContractWords : public testing::TestWithParam<WrongWords> {};

// FOLDER in the arguments stands for the test's folder.
std::string with_folder(std::string text, const TestFolder& folder) {
    const std::string word = "FOLDER";
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word)) {
        text.replace(at, word.size(), folder.path().string());
    }
    return text;
}

TEST_P(ContractWords, EndWithOneLineAndStatusTwo) {
    const TestFolder folder;
    write_file(folder / "file", "text");
    write_file(folder / "taken.graph", "text");
    const ProgramRun run = run_program(with_folder(GetParam().arguments, folder), folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.output, "");
    EXPECT_THAT(run.errors, StartsWith("patina: "));
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_THAT(run.errors, HasSubstr(with_folder(GetParam().message, folder)));
    EXPECT_THAT(run.errors, HasSubstr("(expected "));
}

INSTANTIATE_TEST_SUITE_P(
    Table,
    ContractWords,
    testing::Values(
        WrongWords{"NoCommand", "", "patina: command: is missing"},
        WrongWords{"UnknownCommand", "measure", "patina: measure: is not a command"},
        WrongWords{"ExportIsLater", "export x", "patina: export: follows in a later version"},
        WrongWords{"ViewIsLater", "view x", "patina: view: follows in a later version"},
        WrongWords{"ImportIsLater", "import x", "patina: import: follows in a later version"},
        WrongWords{"UnknownFlag", "estimate a -o b --frobnicate", "--frobnicate: is not"},
        WrongWords{"OneWordTooMany", "info a b", "patina: b: is not understood"},
        WrongWords{"NoCapture", "estimate -o FOLDER/r", "patina: CAPTURE: is missing"},
        WrongWords{"NoOutput", "estimate a", "patina: --output: is missing"},
        WrongWords{"FlagWithoutValue", "estimate a -o b --seed", "--seed"},
        WrongWords{"UnknownMethod",
                   "estimate a -o FOLDER/r --method magic",
                   R"(patina: --method: is "magic" (expected direct, diffuse, photon or gather))"},
        WrongWords{"NumberWithLetters", "info a --threads 2x", R"(--threads: is "2x")"},
        WrongWords{"NegativeSeed", "info a --seed=-1", R"(--seed: is "-1")"},
        WrongWords{"TooFewPhotons",
                   "estimate a -o FOLDER/r --photons 1",
                   R"(patina: --photons: is "1" (expected a whole number, 2 to 1000000000))"},
        WrongWords{"NotANumber", "estimate a -o b --threshold nan", R"(--threshold: is "nan")"},
        WrongWords{"UnknownObject", "simulate D -o FOLDER/c", "(expected "},
        WrongWords{"OddTexels", "simulate A -o FOLDER/c --texels 9", "--texels: "},
        WrongWords{"UnknownLamp", "simulate A -o FOLDER/c --lights 60 --quiet", "--lights: "},
        WrongWords{"MissingCapture", "info FOLDER/none", "patina: FOLDER/none: does not exist"},
        WrongWords{"TooLongCapture", "info " + std::string(300, 'a'), ": is refused: "},
        WrongWords{"GraphIsAnotherFile",
                   "estimate a -o FOLDER/r --graph FOLDER/file",
                   "patina: FOLDER/file: is no gather graph"},
        WrongWords{"AnotherFileWhereTheGraphWouldLie",
                   "estimate a -o FOLDER/taken/",
                   "patina: FOLDER/taken.graph: is no gather graph"},
        WrongWords{"ResultIsItsOwnFolder",
                   "estimate FOLDER/none -o FOLDER/.",
                   "patina: FOLDER/none: does not exist"},
        WrongWords{"ResultHasNoName", "estimate a -o ''", "patina: -o: is empty"},
        WrongWords{"ResultCannotBeWritten",
                   "estimate a -o /proc/none/c",
                   "patina: /proc/none/c: cannot be written"},
        WrongWords{"NoGraphOfAnotherMethod",
                   "estimate FOLDER/none -o FOLDER/r --graph none --method photon",
                   "patina: FOLDER/none: does not exist"},
        WrongWords{"GraphInTheResult",
                   "estimate a -o FOLDER/r --graph FOLDER/r/graph",
                   "patina: --graph: lies in the result's folder"},
        WrongWords{"GraphOfAnotherMethod",
                   "estimate a -o FOLDER/r --graph FOLDER/graph --method photon",
                   "patina: --graph: is of no use to this method"},
        WrongWords{"MemoryOfAnotherMethod",
                   "estimate a -o FOLDER/r --memory 4 --method photon",
                   "patina: --memory: is not known to this method"},
        WrongWords{"OutputIsAFile",
                   "simulate A -o FOLDER/file",
                   "patina: FOLDER/file: exists and is not a folder"},
        WrongWords{"OutputCannotBeWritten", "simulate A -o /proc/none/c", "cannot be written"}),
    [](const auto& values) { return values.param.name; });

TEST(ContractHelp, SaysWhatEachCommandDoesWithAnExample) {
    const TestFolder folder;
    for (const std::string command :
         {"demo", "info", "simulate", "plan", "estimate", "render", "compare"}) {
        const ProgramRun run = run_program(command + " --help", folder.path());
        EXPECT_EQ(run.status, 0) << command;
        EXPECT_THAT(run.output, HasSubstr("Example: patina " + command)) << command;
        for (const char* const flag : {"--seed", "--threads", "--quiet", "--json"}) {
            EXPECT_THAT(run.output, HasSubstr(flag)) << command;
        }
        EXPECT_EQ(run.errors, "") << command;
    }
}

TEST(ContractHelp, ListsTheCommands) {
    const TestFolder folder;
    const ProgramRun run = run_program("--help", folder.path());
    EXPECT_EQ(run.status, 0);
    EXPECT_THAT(run.output, HasSubstr("estimate"));
    EXPECT_THAT(run.output, HasSubstr("compare"));
}

TEST(ContractHelp, PrintsTheVersion) {
    const TestFolder folder;
    const ProgramRun run = run_program("--version", folder.path());
    EXPECT_EQ(run.status, 0);
    EXPECT_THAT(run.output, testing::MatchesRegex("patina [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(ContractHelp, AgreesWithTheDocumentation) {
    const TestFolder folder;
    const ProgramRun run = run_program("--help-markdown", folder.path());
    EXPECT_EQ(run.status, 0);
    const std::string page = read_file(PATINA_SOURCE_DIR "/docs/commands.md");
    EXPECT_TRUE(page.ends_with(run.output))
        << "docs/commands.md does not end with what `patina --help-markdown` prints";
}

}  // namespace
}  // namespace patina
