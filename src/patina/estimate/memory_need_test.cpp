#include "patina/estimate/memory_need.h"

#include "patina/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace patina {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

// 60 lamps that turn, over a million texels.
MemoryCounts large_scan() {
    MemoryCounts counts;
    counts.held = 1e8;
    counts.texels = 1 << 20;
    counts.cameras = 1;
    counts.shots = 60;
    counts.lamps = 60;
    counts.lamp_sets = 60;
    counts.turning_blocks = 8;
    counts.image_pixels = 1 << 20;
    counts.filter_radius = 2;
    counts.looks = {40U << 20, 40U << 20};
    counts.photons = 60.0 * (1 << 20);
    counts.hits = {{32.0 * (1 << 20), 8.0 * (1 << 20)}, {{16.0 * (1 << 20), 4.0 * (1 << 20)}}};
    return counts;
}

TEST(MemoryNeed, IsThatOfTheLargestVectorsByTheirSizes) {
    const MemoryCounts counts = large_scan();
    const MemoryNeed need = memory_need(counts, counts.turning_blocks);
    // Hits of 24 bytes, glossy ones of 12, offsets of 8; lanes of 3 x 8 numbers of 16 bits for each
    // block.
    EXPECT_EQ(need.graph, (48.0 * 24 + 12.0 * 12 + 4 * 8) * (1 << 20));
    EXPECT_GT(need.lanes, 8 * 48 * 48.0 * (1 << 20));
    EXPECT_LT(need.lanes, 1.2 * 8 * 48 * 48.0 * (1 << 20));
    EXPECT_EQ(need.photons, counts.photons);
    EXPECT_EQ(need.peak,
              counts.held + need.views + need.looks + need.graph + need.lanes + need.light +
                  need.photons + need.texels);
}

TEST(MemoryNeed, FallsWithEveryBlockThatIsNotKept) {
    MemoryCounts counts = large_scan();
    counts.turning_blocks = 2;
    counts.standing_blocks = 2;
    const double hits = 48.0 * (1 << 20);
    const auto gain = [&](std::size_t kept) {
        return memory_need(counts, kept + 1).peak - memory_need(counts, kept).peak;
    };
    // While it is worked on, one that is not kept is there as well, one that turns first.
    EXPECT_DOUBLE_EQ(gain(0), 48 * hits);
    EXPECT_DOUBLE_EQ(gain(1), 18 * hits);
    EXPECT_DOUBLE_EQ(gain(2), 18 * hits);
    EXPECT_EQ(gain(3), 0);
}

TEST(MemoryPlan, KeepsWhatFits) {
    const MemoryCounts counts = large_scan();
    EXPECT_EQ(plan_memory(counts, std::numeric_limits<double>::infinity()).kept_blocks, 8U);
    for (const std::size_t kept : {0U, 3U, 6U}) {
        const double need = memory_need(counts, kept).peak;
        const MemoryPlan plan = plan_memory(counts, need);
        EXPECT_EQ(plan.kept_blocks, kept);
        EXPECT_EQ(plan.peak, need);
    }
    EXPECT_THAT(memory_words(plan_memory(counts, memory_need(counts, 1).peak), counts),
                AllOf(StartsWith("memory: about "), HasSubstr(" GiB; "), HasSubstr(" 7 of 8 ")));
}

TEST(MemoryPlan, SaysWhatIsNeededAndWhatLowersIt) {
    MemoryCounts counts = large_scan();
    const auto expect_error = [&](const char* advice) {
        EXPECT_THAT([&] { (void)plan_memory(counts, 0.99 * memory_need(counts, 0).peak); },
                    ThrowsMessage<Error>(AllOf(HasSubstr("--memory: is "),
                                               HasSubstr(" GiB, too little for this capture"),
                                               HasSubstr(" GiB or more; "),
                                               HasSubstr(advice))));
    };
    expect_error("shots marked as held out");
    counts.hits.irradiance.hits *= 4;
    expect_error("fewer --gather-rays and --lobe-rays");
    counts.photons *= 1000;
    expect_error("fewer --photons");
}

}  // namespace
}  // namespace patina
