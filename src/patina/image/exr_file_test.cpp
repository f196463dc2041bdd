#include "patina/image/exr_file.h"

#include "patina/base/error.h"
#include "patina/base/test_folder.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kWidth = 6;
constexpr int kHeight = 4;
constexpr std::size_t kNumPixels = std::size_t{kWidth} * kHeight;

// Channels of one value each, as sources of a frame buffer.
class Channels {
  public:
    using Values = std::map<std::string, float>;

    // All of one type and sampling; values must be whole numbers.
    explicit Channels(const Values& values, Imf::PixelType type = Imf::FLOAT, int sampling = 1) {
        for (const auto& [name, value] : values) add(name, value, type, sampling);
    }
    void add(const std::string& name, float value, Imf::PixelType type, int sampling = 1) {
        types_.emplace(name, Imf::Channel(type, sampling, sampling));
        floats_[name].assign(kNumPixels, value);
        halves_[name].assign(kNumPixels, half(value));
        integers_[name].assign(kNumPixels, static_cast<unsigned>(value));
    }
    void declare(Imf::Header& header) const {
        for (const auto& [name, channel] : types_) header.channels().insert(name, channel);
    }
    // OpenEXR wants the address that pixel (0, 0) would have.
    [[nodiscard]] Imf::FrameBuffer frame(const Imf::Header& header) const {
        Imf::FrameBuffer frame;
        for (const auto& [name, channel] : types_) {
            const void* samples = floats_.at(name).data();
            if (channel.type == Imf::HALF) samples = halves_.at(name).data();
            if (channel.type == Imf::UINT) samples = integers_.at(name).data();
            const std::size_t bytes = channel.type == Imf::HALF ? sizeof(half) : sizeof(float);
            frame.insert(name,
                         Imf::Slice::Make(channel.type,
                                          samples,
                                          header.dataWindow(),
                                          bytes,
                                          bytes * kWidth,
                                          channel.xSampling,
                                          channel.ySampling));
        }
        return frame;
    }

  private:
    std::map<std::string, Imf::Channel> types_;
    std::map<std::string, std::vector<float>> floats_;
    std::map<std::string, std::vector<half>> halves_;
    std::map<std::string, std::vector<unsigned>> integers_;
};

void write(const fs::path& path,
           const Channels& channels,
           Imf::Header header = Imf::Header(kWidth, kHeight)) {
    channels.declare(header);
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(channels.frame(header));
    file.writePixels(kHeight);
}

std::vector<float> first_pixel(const fs::path& path) {
    const Image image = read_exr({path, ""});
    EXPECT_EQ(image.width, kWidth);
    EXPECT_EQ(image.height, kHeight);
    return {image.data.begin(), image.data.begin() + image.channels};
}

void expect_refused(const fs::path& path, const std::string& message) {
    EXPECT_THAT(
        [&] {
            (void)read_exr({path, "image"});
        },
        testing::ThrowsMessage<Error>(HasSubstr(": image: " + message)));
    EXPECT_THAT(
        [&] {
            (void)read_exr_size({path, "image"});
        },
        testing::ThrowsMessage<Error>(HasSubstr(": image: " + message)));
}

TEST(ExrFile, ChannelsAreFoundByName) {
    const TestFolder folder;
    const fs::path path = folder / "a.exr";
    write(path, Channels({{"A", 0}, {"B", 3}, {"G", 2}, {"R", 1}, {"Z", 9}}));
    EXPECT_THAT(first_pixel(path), ElementsAre(1, 2, 3));
    write(path, Channels({{"diffuse.B", 3}, {"diffuse.G", 2}, {"diffuse.R", 1}}));
    EXPECT_THAT(first_pixel(path), ElementsAre(1, 2, 3));
    write(path, Channels({{"Y", 4}, {"Z", 5}}));
    EXPECT_THAT(first_pixel(path), ElementsAre(4));
    write(path, Channels({{"depth", 5}}));
    EXPECT_THAT(first_pixel(path), ElementsAre(5));
    write(path, Channels({{"A", 1}, {"depth", 5}}));
    EXPECT_THAT(first_pixel(path), ElementsAre(5));
}

TEST(ExrFile, TheFirstOfSeveralLayersCounts) {
    const TestFolder folder;
    const fs::path path = folder / "a.exr";
    Channels channels({{"b.R", 4}, {"b.G", 5}, {"b.B", 6}, {"a.R", 1}, {"a.G", 2}, {"a.B", 3}});
    write(path, channels);
    EXPECT_THAT(first_pixel(path), ElementsAre(1, 2, 3));
    for (const char* name : {"R", "G", "B"}) channels.add(name, 7, Imf::FLOAT);
    write(path, channels);
    EXPECT_THAT(first_pixel(path), ElementsAre(7, 7, 7));
}

TEST(ExrFile, RefusesChannelsItCannotOrder) {
    const TestFolder folder;
    write(folder / "a.exr", Channels({{"u", 1}, {"w", 2}}));
    expect_refused(folder / "a.exr", "has the channels u, w (expected");
    write(folder / "b.exr", Channels({{"BY", 1}, {"RY", 2}, {"Y", 2}}));
    expect_refused(folder / "b.exr", "has the channels BY, RY, Y (expected");
}

TEST(ExrFile, HalvesAndFloatsMayBeMixed) {
    const TestFolder folder;
    Channels channels({{"R", 1}, {"B", 3}}, Imf::HALF);
    channels.add("G", 2, Imf::FLOAT);
    write(folder / "a.exr", channels);
    EXPECT_THAT(first_pixel(folder / "a.exr"), ElementsAre(1, 2, 3));
}

TEST(ExrFile, RefusesIntegersWhereTheyAreWanted) {
    const TestFolder folder;
    write(folder / "a.exr", Channels({{"Y", 1}}, Imf::UINT));
    expect_refused(folder / "a.exr", "has samples of type uint (expected");
    Channels channels({{"R", 1}, {"G", 2}, {"B", 3}});
    channels.add("id", 4, Imf::UINT);
    write(folder / "b.exr", channels);
    EXPECT_THAT(first_pixel(folder / "b.exr"), ElementsAre(1, 2, 3));
}

TEST(ExrFile, RefusesSubSampledChannelsWhereTheyAreWanted) {
    const TestFolder folder;
    constexpr int kSampling = 2;
    write(folder / "a.exr", Channels({{"R", 1}, {"G", 2}, {"B", 3}}, Imf::HALF, kSampling));
    expect_refused(folder / "a.exr", "has a sub-sampled channel R (expected");
    Channels channels({{"R", 1}, {"G", 2}, {"B", 3}});
    channels.add("mask", 4, Imf::HALF, kSampling);
    write(folder / "b.exr", channels);
    EXPECT_THAT(first_pixel(folder / "b.exr"), ElementsAre(1, 2, 3));
}

TEST(ExrFile, RefusesACropButNotAShift) {
    const TestFolder folder;
    Imf::Header header(kWidth, kHeight);
    header.dataWindow().min += Imath::V2i(3, -2);
    header.dataWindow().max += Imath::V2i(3, -2);
    write(folder / "a.exr", Channels({{"Y", 1}}), header);
    expect_refused(folder / "a.exr", "has a data window that is not its display window");
    header.displayWindow() = header.dataWindow();
    write(folder / "b.exr", Channels({{"Y", 1}}), header);
    EXPECT_THAT(read_exr({folder / "b.exr", ""}).data, Each(1));
}

TEST(ExrFile, ReadsTheFullResolutionOfTiles) {
    const TestFolder folder;
    const fs::path path = folder / "a.exr";
    const Channels channels({{"R", 1}, {"G", 2}, {"B", 3}}, Imf::HALF);
    for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
        Imf::Header header(kWidth, kHeight);
        header.setTileDescription(Imf::TileDescription(4, 4, mode));
        channels.declare(header);
        {
            Imf::TiledOutputFile file(path.c_str(), header);
            file.setFrameBuffer(channels.frame(header));
            for (int level = 0; level < file.numLevels(); ++level) {
                const int last_x = file.numXTiles(level) - 1;
                file.writeTiles(0, last_x, 0, file.numYTiles(level) - 1, level);
            }
        }
        EXPECT_THAT(first_pixel(path), ElementsAre(1, 2, 3));
        EXPECT_EQ(read_exr({path, ""}).at(kWidth - 1, kHeight - 1, 2), 3);
    }
}

TEST(ExrFile, AMissingTileIsAnError) {
    const TestFolder folder;
    const fs::path path = folder / "a.exr";
    const Channels channels({{"Y", 1}});
    Imf::Header header(kWidth, kHeight);
    header.setTileDescription(Imf::TileDescription(4, 4));
    channels.declare(header);
    {
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(channels.frame(header));
        file.writeTile(0, 0);
    }
    EXPECT_THAT(
        [&] {
            (void)read_exr({path, ""});
        },
        testing::ThrowsMessage<Error>(HasSubstr("is damaged or truncated: ")));
}

TEST(ExrFile, ReadsTheFirstOfSeveralParts) {
    const TestFolder folder;
    const std::vector<Channels> channels = {Channels({{"R", 1}, {"G", 2}, {"B", 3}}),
                                            Channels({{"Y", 4}})};
    std::vector<Imf::Header> headers(2, Imf::Header(kWidth, kHeight));
    for (std::size_t k = 0; k < headers.size(); ++k) {
        headers[k].setName(std::to_string(k));
        headers[k].setType(Imf::SCANLINEIMAGE);
        channels[k].declare(headers[k]);
    }
    {
        Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 2);
        for (std::size_t k = 0; k < headers.size(); ++k) {
            Imf::OutputPart part(file, static_cast<int>(k));
            part.setFrameBuffer(channels[k].frame(headers[k]));
            part.writePixels(kHeight);
        }
    }
    EXPECT_THAT(first_pixel(folder / "a.exr"), ElementsAre(1, 2, 3));
}

TEST(ExrFile, RefusesDeepImages) {
    const TestFolder folder;
    Imf::Header header(kWidth, kHeight);
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    const std::vector<unsigned> counts(kNumPixels, 0);
    const std::vector<const float*> samples(kNumPixels, nullptr);
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(Imf::Slice::Make(Imf::UINT,
                                                  counts.data(),
                                                  header.dataWindow(),
                                                  sizeof(unsigned),
                                                  sizeof(unsigned) * kWidth));
    const Imf::Slice slice = Imf::Slice::Make(
        Imf::FLOAT, samples.data(), header.dataWindow(), sizeof(float*), sizeof(float*) * kWidth);
    frame.insert(
        "Z", Imf::DeepSlice(Imf::FLOAT, slice.base, slice.xStride, slice.yStride, sizeof(float)));
    {
        Imf::DeepScanLineOutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(kHeight);
    }
    expect_refused(folder / "a.exr", "is a deep or volume image (expected a flat image)");
}

}  // namespace
}  // namespace patina
