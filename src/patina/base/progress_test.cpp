#include "patina/base/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace patina {
namespace {

using testing::ElementsAre;
using testing::Field;

// Were a part counted twice, both stages would hold the time in which it slept.
TEST(Progress, CountsAPartOfAStageOnce) {
    using Seconds = std::chrono::duration<double>;
    const auto begin = std::chrono::steady_clock::now();
    Progress progress;
    progress.begin_stage("method", 2, "turns");
    for (int turn = 0; turn < 2; ++turn) {
        progress.begin_stage("photons");
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        progress.end_stage();
        progress.advance(1);
    }
    progress.end_stage("2 turns");
    const Seconds whole = std::chrono::steady_clock::now() - begin;

    const std::vector<StageTime> times = progress.stage_times();
    ASSERT_THAT(
        times,
        ElementsAre(Field(&StageTime::stage, "photons"), Field(&StageTime::stage, "method")));
    EXPECT_GE(times[0].seconds, 0.010);
    EXPECT_LE(times[0].seconds + times[1].seconds, whole.count());
}

TEST(Progress, GoesOnWithTheStageAfterItsPart) {
    Progress progress;
    progress.begin_stage("whole");
    progress.begin_stage("part");
    progress.end_stage();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    progress.end_stage();
    progress.end_stage();  // none is left
    ASSERT_EQ(progress.stage_times().size(), 2u);
    EXPECT_GE(progress.stage_times()[1].seconds, 0.005);
}

}  // namespace
}  // namespace patina
