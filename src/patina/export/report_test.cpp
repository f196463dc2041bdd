#include "patina/export/report.h"

#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"
#include "patina/export/lamp_map.h"
#include "patina/export/page_checks.h"
#include "patina/export/paper_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace patina {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kWidth = 24;
constexpr int kHeight = 16;

ReportMaps make_maps(float diffuse) {
    ReportMaps maps;
    maps.diffuse = Image(kWidth, kHeight, 3, diffuse);
    maps.specular = Image(kWidth, kHeight, 1, 0.2F);
    maps.roughness = Image(kWidth, kHeight, 1, 0.15F);
    maps.status = Image(kWidth, kHeight, 1, 1);
    for (int x = 0; x < kWidth; ++x) maps.status.at(x, 0) = 0;
    return maps;
}

MethodReport make_method(const std::string& name, double error) {
    MethodReport method;
    method.method = name;
    method.maps = make_maps(float(0.5 * (1 + error)));
    for (int turn = 0; turn < 4; ++turn) {
        IterationLog log;
        log.stage = name;
        log.error = 0.0625 * std::pow(0.5, turn);
        log.change = std::pow(0.25, turn);
        log.spectral_radius = 0.4375;
        method.iterations.push_back(log);
    }
    method.converged = true;
    CertaintyMaps& certainty = method.certainty;
    certainty.diffuse_stderr = Image(kWidth, kHeight, 3, 0.01F);
    certainty.specular_stderr = Image(kWidth, kHeight, 1, std::numeric_limits<float>::infinity());
    certainty.roughness_stderr = Image(kWidth, kHeight, 1, 0.02F);
    certainty.measurability = Image(kWidth, kHeight, 3, 0.04F);
    certainty.reason = Image(kWidth, kHeight, 1, 1);
    for (int x = 0; x < kWidth; ++x) {
        certainty.reason.at(x, 0) = 0;
        for (int y = 1; y < 4; ++y) certainty.reason.at(x, y) = 4;
    }
    method.scale = ScaleEstimate{true, 1.5, 0.0375, 1.5, ""};
    method.heldout = LevelComparison{10 * error, 100 * error, error};
    method.used = LevelComparison{11 * error, 110 * error, 1.1 * error};
    method.truth_diffuse = TruthComparison{error, 0.9 * error, 0.4 * error, 0.68, 0.95};
    method.synthetic = Image(kWidth, kHeight, 3, float(0.4 * (1 + error)));
    method.times = {{"photons", 12.25}, {"fit", 1.5}};
    return method;
}

SelectionReport make_selection() {
    SelectionReport selection;
    for (int i = 0; i < 6; ++i) {
        Light lamp;
        lamp.id = "L" + std::to_string(i);
        lamp.position = Vec3(0.05 * (i % 3), 0.05 * double(i / 3), 0.5);
        selection.lamps.push_back(lamp);
        selection.candidates.push_back(std::size_t(i));
    }
    selection.chosen = {4, 0, 5};
    selection.chosen_for_diffuse = {4};
    selection.shares = {{0.5, 0}, {0.75, 0.125}, {0.875, 0.25}};
    selection.share_with_all = {0.9375, 0.3125};
    // Random has no fourth lamp to offer, paper not even a third.
    selection.rules = {{"paper", {0, 0.1, 0.2}, {0, 0.3, 0.4}, {0, 0.5, 0.625}},
                       {"random", {0, 0.1, 0.125, 0.25}, {0, 0.1, 0.2, 0.3}, {0, 0.2, 0.4, 0.6}}};
    return selection;
}

ReportData make_data() {
    ReportData data;
    data.run.title = "Run of <today>";
    data.run.version = "1.2.3";
    data.run.seed = 424242;
    data.run.command = "patina demo -o \"a & b\"";
    data.run.settings = {{"photons", "2 000 000"}};
    ObjectReport b;
    b.name = "B";
    b.title = "object B, a <cat>";
    b.truth = make_maps(0.5F);
    b.methods = {
        make_method("direct", 0.4), make_method("diffuse", 0.2), make_method("photon", 0.0123)};
    b.selection = make_selection();
    b.real = Image(kWidth, kHeight, 3, 0.4F);
    b.real_title = "held-out lamp";
    ObjectReport a = b;
    a.name = "A";
    a.title = "object A, two plates";
    a.profile_edge = 8;
    data.objects = {a, b};
    return data;
}

TEST(ReportPage, IsWellFormedAndNeedsNoNetwork) {
    const std::string page = report_page(make_data());
    EXPECT_EQ(nesting_error(page), "");
    for (const char* part :
         {"http:", "https:", "src=\"//", "@import", "url(", "<script", "<link"}) {
        EXPECT_THAT(page, Not(HasSubstr(part)));
    }
    EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(ReportPage, EscapesNames) {
    const std::string page = report_page(make_data());
    EXPECT_THAT(page, AllOf(HasSubstr("Run of &lt;today&gt;"), Not(HasSubstr("<today>"))));
    EXPECT_THAT(page, AllOf(HasSubstr("a &lt;cat&gt;"), Not(HasSubstr("<cat>"))));
    EXPECT_THAT(page, HasSubstr("patina demo -o &quot;a &amp; b&quot;"));
}

TEST(ReportPage, ShowsEverySectionAndItsNumbers) {
    const std::string page = report_page(make_data());
    for (const char* id : {"glance",
                           "differences",
                           "profiles",
                           "images",
                           "lamps",
                           "maps",
                           "certainty",
                           "scale",
                           "truth",
                           "convergence",
                           "times"}) {
        EXPECT_THAT(page, HasSubstr("<section id=\"" + std::string(id) + "\">"));
    }
    // Ours, the paper's, the seed, lambda, Fig. 4(d)'s pair, a share, a time; rules at three lamps,
    // the share of a reason (3 of 15 rows), the lamps' strength and its error.
    for (const char* number : {">4.00<",
                               ">493.3<",
                               ">0.51<",
                               "424242",
                               ">0.438<",
                               ">3 (1)<",
                               ">87.5\u202f%<",
                               ">12.2\u202fs<",
                               ">62.5\u202f%<",
                               ">25.0\u202f%<",
                               ">20.0\u202f%<",
                               ">1.500<",
                               ">3.8\u202f%<",
                               "1.2.3"}) {
        EXPECT_THAT(page, HasSubstr(number)) << number;
    }
}

TEST(ReportPage, ThePapersFiguresAppearForItsExperimentsAlone) {
    ReportData data = make_data();
    data.paper_experiments = false;
    const std::string page = report_page(data);
    EXPECT_THAT(page, Not(HasSubstr("493.3")));
    EXPECT_THAT(page, Not(HasSubstr("The paper\u2019s Figure")));
    EXPECT_THAT(page, Not(HasSubstr("Table 1")));
    EXPECT_THAT(page, HasSubstr("<section id=\"differences\">"));
}

TEST(ReportPage, LeavesOutWhatIsMissing) {
    ReportData data;
    data.run.title = "One estimate";
    data.paper_experiments = false;
    ObjectReport object;
    object.name = "cup";
    object.title = "a cup";
    MethodReport method;
    method.method = "photon";
    method.maps = make_maps(0.3F);
    object.methods = {method};
    data.objects = {object};
    const std::string page = report_page(data);
    EXPECT_EQ(nesting_error(page), "");
    EXPECT_THAT(page, HasSubstr("<section id=\"maps\">"));
    for (const char* id : {"differences",
                           "profiles",
                           "images",
                           "lamps",
                           "certainty",
                           "scale",
                           "truth",
                           "convergence"}) {
        EXPECT_THAT(page, Not(HasSubstr("<section id=\"" + std::string(id) + "\">")));
    }
    data.objects.clear();
    EXPECT_EQ(nesting_error(report_page(data)), "");
}

TEST(ReportPage, ReducesLargePictures) {
    ReportData data = make_data();
    data.max_picture_width = 16;
    const std::string page = report_page(data);
    EXPECT_THAT(page, HasSubstr("<img class=\"coarse\" width=\"12\" height=\"8\""));
    EXPECT_THAT(page, Not(HasSubstr("width=\"24\"")));
}

TEST(ReportPage, IsTheSameForTheSameData) {
    EXPECT_EQ(report_page(make_data()), report_page(make_data()));
}

TEST(WriteReport, WritesThePage) {
    const TestFolder folder;
    write_report(folder.path() / "report.html", make_data());
    EXPECT_EQ(read_file(folder.path() / "report.html"), report_page(make_data()));
}

TEST(LampMap, DrawsAGridToScaleAndInOrder) {
    const std::string svg = lamp_map(make_selection());
    EXPECT_EQ(nesting_error(svg), "");
    for (const char* part : {">1</text>", ">2</text>", ">3</text>", "<title>L5</title>"}) {
        EXPECT_THAT(svg, HasSubstr(part));
    }
    EXPECT_THAT(svg, HasSubstr(" m</text>"));
    EXPECT_EQ(lamp_map({}), "");
}

TEST(LampMap, DrawsDomesByAngle) {
    SelectionReport dome;
    for (int i = 0; i < 12; ++i) {
        const double azimuth = 2 * kPi * i / 12;
        Light lamp;
        lamp.id = "D" + std::to_string(i);
        lamp.position = Vec3(std::cos(azimuth), 0.1, std::sin(azimuth));
        dome.lamps.push_back(lamp);
        dome.candidates.push_back(std::size_t(i));
    }
    const std::string svg = lamp_map(dome);
    EXPECT_EQ(nesting_error(svg), "");
    EXPECT_THAT(svg, HasSubstr("degrees</text>"));
}

TEST(PaperTable1, HoldsThePrintedFigures) {
    EXPECT_EQ(paper_table_1("B", "diffuse")->levels_variance, 493.3);
    EXPECT_EQ(paper_table_1("C", "photon")->levels_mean, 0.92);
    EXPECT_FALSE(paper_table_1("A", "photon").has_value());
    EXPECT_FALSE(paper_table_1("B", "direct").has_value());
}

}  // namespace
}  // namespace patina
