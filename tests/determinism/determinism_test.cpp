// The program's files, byte by byte, for one thread and for two.
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"
#include "patina/capture/json.h"

#include <gtest/gtest.h>

#include "support/program.h"
#include "support/tiny_capture.h"
#include <map>
#include <string>

namespace patina {
namespace {

namespace fs = std::filesystem;

// result.json says how long each stage took, and that may differ.
std::string without_timing(const std::string& text) {
    const Json document = parse_json(text, "result.json");
    Json kept = Json::object();
    for (const std::string& name : document.names) {
        if (name != "timing") kept.set(name, *document.find(name));
    }
    return to_text(kept);
}

// Every file below the folder, by its relative path.
std::map<std::string, std::string> files_in(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        std::string bytes = read_file(entry.path());
        if (entry.path().filename() == "result.json") bytes = without_timing(bytes);
        files[fs::relative(entry.path(), folder).string()] = std::move(bytes);
    }
    return files;
}

void expect_equal_files(const fs::path& one, const fs::path& two) {
    const auto files_of_one = files_in(one);
    const auto files_of_two = files_in(two);
    ASSERT_FALSE(files_of_one.empty());
    ASSERT_EQ(files_of_one.size(), files_of_two.size());
    for (const auto& [name, bytes] : files_of_one) {
        ASSERT_TRUE(files_of_two.contains(name)) << name;
        EXPECT_TRUE(bytes == files_of_two.at(name)) << name << " differs";
    }
}

// Runs `arguments` with one thread and with two and compares what they leave.
void expect_same_for_all_threads(const std::string& arguments, const TestFolder& folder) {
    for (const char* const threads : {"1", "2"}) {
        const ProgramRun run = run_program(arguments + " --quiet --threads " + threads + " -o '" +
                                               (folder / threads).string() + "'",
                                           folder.path());
        ASSERT_EQ(run.status, 0) << run.errors;
    }
    expect_equal_files(folder / "1", folder / "2");
}

TEST(Determinism, SimulateLeavesTheSameBytesForAllThreads) {
    const TestFolder folder;
    expect_same_for_all_threads(
        "simulate B --texels 24x16 --samples 4 --lights 3,40 --lamp-error 0.001", folder);
}

class DeterminismOfMethods : public testing::TestWithParam<const char*> {};

TEST_P(DeterminismOfMethods, EstimateLeavesTheSameBytesForAllThreads) {
    const TestFolder folder;
    const std::string capture = make_tiny_capture(folder.path());
    expect_same_for_all_threads("estimate " + capture +
                                    " --photons 20000 --iterations 8 --method " +
                                    std::string(GetParam()),
                                folder);
    EXPECT_EQ(fs::exists(folder / "1.graph"), std::string(GetParam()) == "gather");
}

INSTANTIATE_TEST_SUITE_P(All,
                         DeterminismOfMethods,
                         testing::Values("direct", "diffuse", "photon", "gather"),
                         [](const auto& values) { return std::string(values.param); });

TEST(Determinism, RenderLeavesTheSameBytesForAllThreads) {
    const TestFolder folder;
    const std::string capture = make_tiny_capture(folder.path());
    const std::string result = "'" + (folder / "result").string() + "'";
    ASSERT_EQ(
        run_program("estimate " + capture + " --quiet --method direct -o " + result, folder.path())
            .status,
        0);
    expect_same_for_all_threads("render " + capture + " " + result + " --samples 8", folder);
}

TEST(Determinism, ASavedGraphLeavesTheSameBytesForAllThreads) {
    const TestFolder folder;
    const std::string capture = make_tiny_capture(folder.path());
    const std::string words = "estimate " + capture + " --iterations 8";
    const std::string graph = " --graph '" + (folder / "graph").string() + "'";
    const auto run = [&](const std::string& arguments, const char* name) {
        const ProgramRun estimate = run_program(
            words + arguments + " -o '" + (folder / name).string() + "'", folder.path());
        EXPECT_EQ(estimate.status, 0) << estimate.errors;
        return estimate.errors;
    };
    const std::string read = "gather graph: read from ";
    run(" --graph none", "without");
    EXPECT_FALSE(fs::exists(folder / "without.graph"));
    EXPECT_EQ(run(graph + " --threads 1", "written").find(read), std::string::npos);
    const std::string bytes = read_file(folder / "graph");
    EXPECT_NE(run(graph + " --threads 2", "read").find(read), std::string::npos);
    expect_equal_files(folder / "without", folder / "written");
    expect_equal_files(folder / "without", folder / "read");
    EXPECT_TRUE(read_file(folder / "graph") == bytes);
    // Traced by two threads.
    fs::remove(folder / "graph");
    run(graph + " --threads 2", "again");
    EXPECT_TRUE(read_file(folder / "graph") == bytes);
    // Beside the result unless told otherwise, also where there is no folder yet.
    EXPECT_EQ(run("", "new/beside").find(read), std::string::npos);
    EXPECT_TRUE(read_file(folder / "new" / "beside.graph") == bytes);
    EXPECT_NE(run("", "new/beside/").find(read), std::string::npos);
    expect_equal_files(folder / "without", folder / "new" / "beside");
}

TEST(Determinism, AnotherSeedGivesOtherBytes) {
    const TestFolder folder;
    const std::string capture = make_tiny_capture(folder.path());
    for (const char* const seed : {"1", "2"}) {
        const ProgramRun run = run_program("estimate " + capture +
                                               " --quiet --method diffuse --photons 20000"
                                               " --iterations 3 --seed " +
                                               seed + " -o '" + (folder / seed).string() + "'",
                                           folder.path());
        ASSERT_EQ(run.status, 0) << run.errors;
    }
    EXPECT_NE(read_file(folder / "1" / "diffuse.exr"), read_file(folder / "2" / "diffuse.exr"));
}

}  // namespace
}  // namespace patina
