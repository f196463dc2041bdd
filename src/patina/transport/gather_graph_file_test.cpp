#include "patina/transport/gather_graph_file.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/same_bytes.h"
#include <chrono>
#include <functional>
#include <thread>

namespace patina {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

bool same_rows(const GatherRows& a, const GatherRows& b) {
    return a.begin == b.begin && a.glossy_begin == b.glossy_begin && same_bytes(a.hits, b.hits) &&
           same_bytes(a.glossy, b.glossy);
}

bool same_graph(const GatherGraph& a, const GatherGraph& b) {
    if (!same_rows(a.irradiance, b.irradiance) || a.lobes.size() != b.lobes.size()) return false;
    for (std::size_t view = 0; view < a.lobes.size(); ++view) {
        if (!same_rows(a.lobes[view], b.lobes[view])) return false;
    }
    return a.num_rays == b.num_rays;
}

// A channel from two cameras.
class GatherGraphFile : public testing::Test {
  protected:
    GatherGraphFile() {
        options_.rays = 8;
        options_.lobe_rays = 8;
        const Vec3f towards = Channel::towards_camera().cast<float>();
        views_.assign(2, ViewDirections(channel_.atlas.texels.size(), towards));
        for (std::size_t i = 0; i < views_[1].size(); i += 2) views_[1][i].setZero();
    }

    [[nodiscard]] Hash128 fingerprint() const {
        return gather_graph_fingerprint(channel_.scene.mesh, channel_.atlas, views_, options_);
    }
    [[nodiscard]] GatherGraph traced() const {
        Progress progress;
        return trace_gather_graph(
            channel_.scene.surface(), channel_.atlas, views_, options_, progress);
    }
    [[nodiscard]] GatherGraph read_or_traced() const {
        Progress progress;
        const Surface surface = channel_.scene.surface();
        KeptGatherGraph kept(file(), surface, channel_.atlas, views_, options_, progress);
        kept.finish(progress);
        return kept.graph();
    }
    [[nodiscard]] std::filesystem::path file() const { return folder_ / "graph"; }

    TestFolder folder_;
    Channel channel_;
    GatherOptions options_;
    std::vector<ViewDirections> views_;
};

TEST_F(GatherGraphFile, ComesBackAsItWas) {
    const GatherGraph graph = traced();
    ASSERT_GT(graph.irradiance.hits.size(), 0U);
    ASSERT_GT(graph.lobes[1].hits.size(), 0U);
    ASSERT_GT(graph.irradiance.glossy.size(), 0U);
    write_gather_graph(file(), fingerprint(), graph);
    const std::optional<GatherGraph> read = read_gather_graph(file(), fingerprint());
    ASSERT_TRUE(read.has_value());
    EXPECT_TRUE(same_graph(graph, *read));
}

TEST_F(GatherGraphFile, IsNotTracedAgainWhereItFits) {
    EXPECT_TRUE(same_graph(read_or_traced(), traced()));
    // A graph that no tracing gives shows that it was read.
    GatherGraph other = traced();
    other.irradiance.hits.front().weight = 123;
    write_gather_graph(file(), fingerprint(), other);
    EXPECT_TRUE(same_graph(read_or_traced(), other));
}

TEST_F(GatherGraphFile, HasAFingerprintOfAllThatTheGraphDependsOn) {
    const Hash128 before = fingerprint();
    const auto expect_change = [&](const char* what, auto& value, auto other) {
        const auto kept = value;
        value = other;
        EXPECT_NE(fingerprint(), before) << what;
        value = kept;
        EXPECT_EQ(fingerprint(), before) << what;
    };
    Mesh& mesh = channel_.scene.mesh;
    TexelAtlas& atlas = channel_.atlas;
    expect_change("position", mesh.positions[1].y(), 7.0f);
    expect_change("normal", mesh.normals[1].y(), 7.0f);
    expect_change("uv", mesh.uvs[1].y(), 7.0f);
    expect_change("triangle", mesh.triangles[1][0], 7U);
    expect_change("width", atlas.width, 1);
    expect_change("texel's position", atlas.texels[3].point.position.x(), 7.0);
    expect_change("texel's normal", atlas.texels[3].point.normal.x(), 7.0);
    expect_change("texel's side", atlas.texels[3].point.geometric_normal.x(), 7.0);
    expect_change("owner", atlas.cell_owner[3], TexelId(77));
    expect_change("neighbor", atlas.neighbors[3], TexelId(77));
    expect_change("view", views_[1][1], Vec3f(0, 0, 0));
    expect_change("views", views_, std::vector<ViewDirections>(1, views_[0]));
    expect_change("rays", options_.rays, 16);
    expect_change("lobe rays", options_.lobe_rays, 16);
    expect_change("spread", options_.lobe_spread, 0.3);
    expect_change("seed", options_.seed, 2U);
}

TEST_F(GatherGraphFile, IsWrittenWhateverBecomesOfTheRest) {
    Progress progress;
    const Surface surface = channel_.scene.surface();
    try {
        const KeptGatherGraph kept(file(), surface, channel_.atlas, views_, options_, progress);
        throw Error("", "", "something else went wrong", "");
    } catch (const Error&) {
        EXPECT_TRUE(read_gather_graph(file(), fingerprint()).has_value());
    }
}

TEST_F(GatherGraphFile, IsKeptNowhereWithoutAName) {
    Progress progress;
    const Surface surface = channel_.scene.surface();
    KeptGatherGraph kept({}, surface, channel_.atlas, views_, options_, progress);
    kept.finish(progress);
    EXPECT_TRUE(same_graph(kept.graph(), traced()));
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(GatherGraphFile, MayBeDeletedAtAnyTime) {
    Progress progress;
    const Surface surface = channel_.scene.surface();
    KeptGatherGraph kept(file(), surface, channel_.atlas, views_, options_, progress);
    for (int wait = 0; wait < 1000 && !std::filesystem::exists(file()); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::filesystem::remove(file());
    EXPECT_NO_THROW(kept.finish(progress));
}

TEST_F(GatherGraphFile, IsOnlyWarnedAboutWhereTheDiskRefuses) {
    Progress progress;
    const Surface surface = channel_.scene.surface();
    KeptGatherGraph kept(
        folder_ / "none" / "graph", surface, channel_.atlas, views_, options_, progress);
    EXPECT_NO_THROW(kept.finish(progress));
    EXPECT_TRUE(same_graph(kept.graph(), traced()));
}

TEST_F(GatherGraphFile, IsReplacedWhereItDoesNotFit) {
    (void)read_or_traced();
    options_.seed = 2;
    EXPECT_FALSE(read_gather_graph(file(), fingerprint()).has_value());
    EXPECT_TRUE(same_graph(read_or_traced(), traced()));
    EXPECT_TRUE(read_gather_graph(file(), fingerprint()).has_value());
}

TEST_F(GatherGraphFile, IsReplacedWhereItIsDamaged) {
    (void)read_or_traced();
    const std::string whole = read_file(file());
    const auto expect_replaced = [&](const std::string& damaged, std::size_t at) {
        write_file(file(), damaged);
        EXPECT_FALSE(read_gather_graph(file(), fingerprint()).has_value()) << at;
    };
    // Cut short, within the magic and the header too.
    for (std::size_t size = 0; size < whole.size(); size = size < 200 ? size + 1 : 2 * size) {
        expect_replaced(whole.substr(0, size), size);
    }
    expect_replaced(whole.substr(0, whole.size() - 1), whole.size() - 1);
    expect_replaced(whole + "x", whole.size() + 1);
    // One bit, anywhere behind the magic.
    for (std::size_t at = 13; at < whole.size(); at = at < 200 ? at + 1 : at + whole.size() / 50) {
        std::string damaged = whole;
        damaged[at] = char(damaged[at] ^ 4);
        expect_replaced(damaged, at);
    }
    EXPECT_TRUE(same_graph(read_or_traced(), traced()));
    EXPECT_EQ(read_file(file()), whole);
}

TEST_F(GatherGraphFile, IsNeverWrittenOverAnotherFile) {
    write_file(file(), "a photograph");
    const auto expect_error = [](const std::function<void()>& work) {
        EXPECT_THAT(work, ThrowsMessage<Error>(HasSubstr("graph: is no gather graph")));
    };
    expect_error([&] { check_gather_graph_file(file()); });
    expect_error([&] { (void)read_or_traced(); });
    EXPECT_EQ(read_file(file()), "a photograph");
}

TEST_F(GatherGraphFile, IsRefusedWhereItCannotBeWritten) {
    EXPECT_THAT([&] { check_gather_graph_file(folder_ / "none" / "graph"); },
                ThrowsMessage<Error>(HasSubstr("cannot be written")));
    EXPECT_THAT([&] { check_gather_graph_file(folder_.path()); },
                ThrowsMessage<Error>(HasSubstr("is not a file")));
    check_gather_graph_file(file());
    EXPECT_FALSE(std::filesystem::exists(file()));
}

}  // namespace
}  // namespace patina
