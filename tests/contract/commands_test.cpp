// What each command leaves on disk and on standard output.
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"
#include "patina/capture/json.h"
#include "patina/capture/result_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program.h"
#include "support/tiny_capture.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace patina {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;

// A capture and its result by a method that takes no time.
class ContractCommands : public testing::Test {
  protected:
    void SetUp() override {
        capture_ = make_tiny_capture(folder_.path());
        result_ = "'" + (folder_ / "result").string() + "'";
        estimate_ = run_program(
            "estimate " + capture_ + " -o " + result_ + " --method direct --json --quiet",
            folder_.path());
        ASSERT_EQ(estimate_.status, 0) << estimate_.errors;
    }

    // Runs a command that must succeed and print one JSON object.
    [[nodiscard]] Json run_json(const std::string& arguments) const {
        const ProgramRun run = run_program(arguments + " --json --quiet", folder_.path());
        EXPECT_EQ(run.status, 0) << run.errors;
        EXPECT_EQ(run.errors, "");
        Json json = parse_json(run.output, arguments);
        EXPECT_EQ(json.kind, JsonKind::object);
        return json;
    }

    TestFolder folder_;
    std::string capture_;
    std::string result_;
    ProgramRun estimate_;
};

TEST_F(ContractCommands, EstimateLeavesAWholeResult) {
    const Result result = read_result(folder_ / "result");
    EXPECT_EQ(result.maps.status.width, 16);
    EXPECT_EQ(result.maps.status.height, 16);
    EXPECT_FALSE(result.mesh.uvs.empty());
    const Json json = parse_json(result.json, "result.json");
    EXPECT_THAT(json.names,
                IsSupersetOf({"format",
                              "version",
                              "name",
                              "method",
                              "settings",
                              "seed",
                              "program_version",
                              "iterations",
                              "converged",
                              "lambda",
                              "noise_scale",
                              "texels",
                              "timing"}));
    EXPECT_THAT(json.find("timing")->names, IsSupersetOf({"stages_s", "peak_memory_bytes"}));
    EXPECT_THAT(json.find("texels")->names,
                IsSupersetOf({"by_status", "by_reason", "seen", "seen_measured_share", "clamped"}));
    for (const Json& turn : json.find("iterations")->items) {
        EXPECT_THAT(turn.names, IsSupersetOf({"error", "change", "lambda", "damping"}));
    }
}

// Images are read side by side; which of them is complained of must not depend on which was read
// sooner.
TEST_F(ContractCommands, OfSeveralDamagedImagesTheFirstIsNamed) {
    const std::filesystem::path images = folder_ / "capture" / "images";
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(images)) {
        if (entry.path().extension() == ".exr") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    ASSERT_GE(files.size(), 3U);
    for (std::size_t i = 1; i < files.size(); ++i) {
        const std::string whole = read_file(files[i]);
        write_file(files[i], whole.substr(0, whole.size() - 40));
    }
    for (int round = 0; round < 5; ++round) {
        const ProgramRun run = run_program(
            "estimate " + capture_ + " -o " + result_ + " --method direct --quiet", folder_.path());
        EXPECT_EQ(run.status, 2);
        EXPECT_THAT(run.errors, HasSubstr(files[1].filename().string()));
        EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    }
}

TEST_F(ContractCommands, EstimateCountsEveryTexelOnce) {
    const Json json = parse_json(estimate_.output, "output");
    std::int64_t sum = 0;
    for (const Json& count : json.find("texels")->find("by_status")->items) sum += count.integer;
    EXPECT_EQ(sum, 16 * 16);
}

TEST_F(ContractCommands, EstimateGivesAReasonForEveryStatus) {
    const Json texels = *parse_json(estimate_.output, "output").find("texels");
    std::array<std::int64_t, kLobeReasons.size()> in_map = {};
    for (const float reason : read_result(folder_ / "result").maps.reason.data) {
        ++in_map[std::size_t(reason)];
    }
    std::int64_t unmeasured = 0;
    for (const LobeReason reason : kLobeReasons) {
        if (reason == LobeReason::off_surface) continue;
        const Json* const count = texels.find("by_reason")->find(lobe_reason_name(reason));
        ASSERT_NE(count, nullptr) << lobe_reason_name(reason);
        EXPECT_EQ(count->integer, in_map[std::size_t(reason)]) << lobe_reason_name(reason);
        if (reason > LobeReason::matte && reason < LobeReason::not_observed) {
            unmeasured += count->integer;
        }
    }
    const auto with = [&](LobeReason reason) { return in_map[std::size_t(reason)]; };
    const Json& by_status = *texels.find("by_status");
    EXPECT_EQ(by_status.find("0")->integer, with(LobeReason::off_surface));
    EXPECT_EQ(by_status.find("1")->integer, with(LobeReason::measured) + with(LobeReason::matte));
    EXPECT_EQ(by_status.find("2")->integer, unmeasured);
    EXPECT_EQ(by_status.find("3")->integer, with(LobeReason::not_observed));
}

TEST_F(ContractCommands, EstimateKeepsItsSettings) {
    const ProgramRun run = run_program("estimate " + capture_ + " -o " + result_ +
                                           " --method direct --seed 7 --max-view-angle 60 --quiet",
                                       folder_.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const Json json = parse_json(read_result(folder_ / "result").json, "result.json");
    EXPECT_EQ(json.find("seed")->integer, 7);
    EXPECT_EQ(json.find("settings")->find("max_view_angle")->number, 60);
}

TEST_F(ContractCommands, EstimatePrintsWhatItWrites) {
    EXPECT_EQ(estimate_.output, read_result(folder_ / "result").json);
}

TEST_F(ContractCommands, CompareUsesTheNamesOfTheContract) {
    const Json json = run_json("compare " + capture_ + " " + result_ + " --samples 4");
    for (const char* const part : {"shots", "heldout"}) {
        ASSERT_NE(json.find(part), nullptr) << part;
        EXPECT_THAT(json.find(part)->names,
                    IsSupersetOf({"levels_mean", "levels_variance", "relative_rmse"}));
    }
    ASSERT_NE(json.find("truth"), nullptr);
    ASSERT_NE(json.find("truth")->find("diffuse"), nullptr);
    EXPECT_THAT(json.find("truth")->find("diffuse")->names,
                IsSupersetOf({"mean_relative_error",
                              "median_absolute_relative_error",
                              "rmse",
                              "coverage68",
                              "coverage95"}));
}

TEST_F(ContractCommands, CompareScalesLevelsByWhite) {
    const std::string words = "compare " + capture_ + " " + result_ + " --samples 2 --white ";
    const double levels_of_one = run_json(words + "1").find("shots")->find("levels_mean")->number;
    const double levels_of_two = run_json(words + "2").find("shots")->find("levels_mean")->number;
    EXPECT_DOUBLE_EQ(levels_of_one, 2 * levels_of_two);
}

TEST_F(ContractCommands, ComparePrintsATable) {
    const ProgramRun run = run_program("compare " + capture_ + " " + result_ + " --samples 2 -o '" +
                                           (folder_ / "pictures").string() + "'",
                                       folder_.path());
    EXPECT_EQ(run.status, 0);
    EXPECT_THAT(run.output, HasSubstr("all held-out shots"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures" / "shot000_difference.png"));
}

TEST_F(ContractCommands, RenderWritesEveryShot) {
    const Json json = run_json("render " + capture_ + " " + result_ + " --samples 2 -o '" +
                               (folder_ / "renders").string() + "'");
    ASSERT_EQ(json.find("shots")->items.size(), 5U);
    const Image image = read_image(folder_ / "renders" / "shot004.exr").image;
    EXPECT_EQ(image.channels, 3);
    for (const float value : image.data) EXPECT_TRUE(std::isfinite(value));
}

TEST_F(ContractCommands, RenderRejectsMapsOfAnotherSize) {
    const std::string other = "'" + (folder_ / "other").string() + "'";
    ASSERT_EQ(run_program("simulate A --texels 8x8 --samples 1 --lights 25 --quiet -o " + other,
                          folder_.path())
                  .status,
              0);
    const ProgramRun run = run_program(
        "render " + other + " " + result_ + " --quiet -o '" + (folder_ / "r").string() + "'",
        folder_.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.errors, HasSubstr("has maps of 16 x 16 texels (expected 8 x 8"));
}

TEST_F(ContractCommands, InfoSaysWhatIsInACaptureAndAResult) {
    const Json capture = run_json("info " + capture_);
    EXPECT_EQ(capture.find("kind")->text, "capture");
    EXPECT_EQ(capture.find("shots")->integer, 5);
    EXPECT_EQ(capture.find("heldout")->integer, 1);
    const Json result = run_json("info " + result_ + " -o '" + (folder_ / "sheet").string() + "'");
    EXPECT_EQ(result.find("kind")->text, "result");
    EXPECT_EQ(result.find("method")->text, "direct");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "sheet" / "sheet.png"));
}

TEST_F(ContractCommands, PlanWritesARigThatCanBePlannedAgain) {
    const std::string rig = "'" + (folder_ / "rig").string() + "'";
    const Json plan = run_json("plan " + capture_ + " -o " + rig);
    const std::size_t num_chosen = plan.find("chosen")->items.size();
    ASSERT_GT(num_chosen, 0U);
    const Json again = run_json("plan " + rig);
    EXPECT_EQ(again.find("candidates")->integer, std::int64_t(num_chosen));
    // A count, then an id and a unit direction for each lamp, in the order of choice.
    std::istringstream directions(read_file(folder_ / "rig" / "chosen.lp"));
    std::size_t count = 0;
    directions >> count;
    ASSERT_EQ(count, num_chosen);
    for (const Json& light : plan.find("chosen")->items) {
        std::string name;
        Vec3 w = Vec3::Zero();
        directions >> name >> w.x() >> w.y() >> w.z();
        EXPECT_EQ(name, light.find("light")->text);
        EXPECT_NEAR(w.norm(), 1, 1e-8);
    }
    EXPECT_NE(read_file(folder_ / "rig" / "plan.html").find("<svg"), std::string::npos);
}

TEST_F(ContractCommands, PlanSaysWhichLookToTakeAfterACapture) {
    const Json plan = run_json("plan " + capture_ + " --dome 8 --given " + capture_ + " --maps " +
                               result_ + " --lamps 2 --next-looks 3");
    EXPECT_EQ(plan.find("chosen")->items.size(), 2U);
    const std::vector<Json>& looks = plan.find("next_looks")->items;
    ASSERT_EQ(looks.size(), 3U);
    EXPECT_EQ(looks[0].find("light")->text, plan.find("chosen")->items[0].find("light")->text);
    EXPECT_GE(looks[0].find("gain")->number, looks[1].find("gain")->number);
    // The shots' own lamps are no candidates.
    EXPECT_EQ(plan.find("candidates")->integer, 8);
}

TEST_F(ContractCommands, PlanNamesTheWordThatDoesNotFit) {
    const auto expect = [&](const std::string& words, const std::string& message) {
        const ProgramRun run = run_program("plan " + capture_ + " " + words, folder_.path());
        EXPECT_EQ(run.status, 2) << words;
        EXPECT_EQ(run.errors, "patina: " + message + "\n");
    };
    expect("--grid 3 --quiet", "--grid: is \"3\" (expected columns and rows such as 128x80)");
    expect("--dome 8 --center 1,2 --quiet",
           "--center: is \"1,2\" (expected three numbers with commas between)");
    expect("--spacing 0.1 --quiet", "--spacing: has nothing to place (expected --grid besides)");
    expect("--taken L12 --given " + capture_ + " --quiet",
           "--taken: is given besides --given (expected one of the two)");
    expect("--given " + capture_ + " --quiet",
           (folder_ / "capture" / "capture.json").string() +
               ": lights: hold no candidate (expected at least one)");
}

}  // namespace
}  // namespace patina
