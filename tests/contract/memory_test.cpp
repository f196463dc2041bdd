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

struct Work {
    std::string object;
    std::string lamps;
    std::string options;
    std::string small;  // texels
    std::string large;
};

// Object B is hollow; under 36 lamps that turn, five blocks of them, the light at the hits is the
// most.
Work much_light_at_hits() {
    std::string lamps = "0";
    for (int lamp = 1; lamp < 36; ++lamp) lamps += "," + std::to_string(lamp);
    return {"B", lamps, "", "64x40", "128x80"};
}

// Few rays under three lamps that stand: what every texel has is the most.
Work many_texels() {
    return {"A", "12,25,42", " --gather-rays 4 --lobe-rays 8", "128x128", "256x256"};
}

// With few photons, which the formula takes every lobe to need, and here few lobes do.
Memory memory_of_estimate(const Work& work, const std::string& texels, const TestFolder& folder) {
    const std::string capture = "'" + (folder / texels).string() + "'";
    const ProgramRun simulate = run_program(
        "simulate " + work.object + " --quiet --samples 1 --heldout-samples 1 --texels " + texels +
            " --lights " + work.lamps + " -o " + capture,
        folder.path());
    EXPECT_EQ(simulate.status, 0) << simulate.errors;
    const ProgramRun estimate =
        run_program("estimate " + capture + " --json --iterations 2 --photons 1000" + work.options +
                        " -o '" + (folder / (texels + "-result")).string() + "'",
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
    for (const Work& work : {much_light_at_hits(), many_texels()}) {
        const TestFolder folder;
        const Memory small = memory_of_estimate(work, work.small, folder);
        const Memory large = memory_of_estimate(work, work.large, folder);
        const double reckoned = large.reckoned - small.reckoned;
        const double peak = large.peak - small.peak;
        EXPECT_GT(reckoned, 0.75 * peak) << work.object;
        EXPECT_LT(reckoned, 1.25 * peak) << work.object;
        EXPECT_GT(large.reckoned, 0.75 * large.peak) << work.object;
        EXPECT_LT(large.reckoned, 1.25 * large.peak) << work.object;
    }
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
