// What estimate says of the memory that it will need, and how it stays within less.
#include "patina/base/test_folder.h"
#include "patina/capture/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program.h"
#include "support/tiny_capture.h"
#include <algorithm>
#include <string>

namespace patina {
namespace {

using testing::HasSubstr;

struct Memory {
    double reckoned = 0;  // [bytes]
    double peak = 0;      // as the system measured it [bytes]
};

// Of an estimate of object B, which is hollow, under 36 lamps that turn: five blocks of them. With
// few photons, which the formula takes every lobe to need, and here few lobes do.
Memory memory_of_estimate(const std::string& texels, const TestFolder& folder) {
    std::string lamps = "0";
    for (int lamp = 1; lamp < 36; ++lamp) lamps += "," + std::to_string(lamp);
    const std::string capture = "'" + (folder / texels).string() + "'";
    const ProgramRun simulate = run_program(
        "simulate B --quiet --samples 1 --heldout-samples 1 "
        "--texels " +
            texels + " --lights " + lamps + " -o " + capture,
        folder.path());
    EXPECT_EQ(simulate.status, 0) << simulate.errors;
    const ProgramRun estimate =
        run_program("estimate " + capture + " --json --iterations 2 --photons 1000 -o '" +
                        (folder / (texels + "-result")).string() + "'",
                    folder.path());
    EXPECT_EQ(estimate.status, 0) << estimate.errors;
    EXPECT_THAT(estimate.errors, HasSubstr("memory: about "));
    const Json json = parse_json(estimate.output, "output");
    const Json& timing = *json.find("timing");
    return {timing.find("reckoned_memory_bytes")->number, timing.find("peak_memory_bytes")->number};
}

// Their differences leave the program itself out. The formula takes every texel for hollow and
// vectors for as long as their elements; allocators round up, threads have stacks and buffers.
TEST(ContractMemory, IsReckonedToAQuarter) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer takes memory of its own";
#endif
    const TestFolder folder;
    const Memory small = memory_of_estimate("64x40", folder);
    const Memory large = memory_of_estimate("128x80", folder);
    const double reckoned = large.reckoned - small.reckoned;
    const double peak = large.peak - small.peak;
    EXPECT_GT(reckoned, 0.75 * peak);
    EXPECT_LT(reckoned, 1.25 * peak);
    EXPECT_GT(large.reckoned, 0.75 * large.peak);
    EXPECT_LT(large.reckoned, 1.25 * large.peak);
}

TEST(ContractMemory, IsRefusedInOneLineWhereItIsTooLittle) {
    const TestFolder folder;
    const std::string capture = make_tiny_capture(folder.path());
    const std::string result = (folder / "result").string();
    const ProgramRun run = run_program(
        "estimate " + capture + " --quiet --memory 0.01 -o '" + result + "'", folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.output, "");
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_THAT(run.errors,
                HasSubstr("patina: --memory: is 0.01 GiB, too little for this capture (expected "));
    EXPECT_FALSE(std::filesystem::exists(result));
}

}  // namespace
}  // namespace patina
