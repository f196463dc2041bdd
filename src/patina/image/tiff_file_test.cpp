#include "patina/image/tiff_file.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"

#include <gmock/gmock.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// How a file is to be written. The blocks are all of its strips or tiles.
struct Recipe {
    int width = 1;
    int height = 1;
    int samples = 3;
    int bits = 8;
    int format = SAMPLEFORMAT_UINT;
    int photometric = PHOTOMETRIC_RGB;
    int planes = PLANARCONFIG_CONTIG;
    int compression = COMPRESSION_NONE;
    int rows_per_strip = 1;
    int tile = 0;  // its side, or 0 for strips
    const char* mode = "w";
    std::function<void(TIFF*)> extras = {};
};

template <typename Sample>
void write(const fs::path& path,
           const Recipe& recipe,
           const std::vector<std::vector<Sample>>& blocks) {
    TIFF* tiff = TIFFOpen(path.c_str(), recipe.mode);
    ASSERT_NE(tiff, nullptr);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, recipe.width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, recipe.height);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, recipe.samples);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, recipe.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, recipe.format);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, recipe.photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, recipe.planes);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, recipe.compression);
    if (recipe.tile > 0) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, recipe.tile);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, recipe.tile);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, recipe.rows_per_strip);
    }
    if (recipe.extras) recipe.extras(tiff);
    for (std::uint32_t k = 0; k < blocks.size(); ++k) {
        std::vector<Sample> block = blocks[k];  // libtiff may swap its bytes
        const auto size = static_cast<tmsize_t>(block.size() * sizeof(Sample));
        const tmsize_t written = recipe.tile > 0
                                     ? TIFFWriteEncodedTile(tiff, k, block.data(), size)
                                     : TIFFWriteEncodedStrip(tiff, k, block.data(), size);
        ASSERT_EQ(written, size);
    }
    TIFFClose(tiff);
}

std::vector<float> samples_of(const fs::path& path) {
    const Image image = read_tiff({path, ""}).image;
    EXPECT_EQ(image.channels, read_tiff_size({path, ""}).channels);
    return image.data;
}

void expect_refused(const fs::path& path, const std::string& message) {
    testing::internal::CaptureStderr();
    EXPECT_THAT(
        [&] {
            (void)read_tiff_size({path, "image"});
        },
        testing::ThrowsMessage<Error>(HasSubstr(": image: " + message)));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Sets the meaning of the samples beyond the colours.
std::function<void(TIFF*)> extra_samples(std::vector<std::uint16_t> meanings) {
    return [meanings = std::move(meanings)](TIFF* tiff) {
        TIFFSetField(
            tiff, TIFFTAG_EXTRASAMPLES, static_cast<int>(meanings.size()), meanings.data());
    };
}

TEST(TiffFile, ReadsUnsignedIntegers) {
    const TestFolder folder;
    Recipe recipe;
    write<std::uint8_t>(folder / "a.tif", recipe, {{0, 51, 255}});
    EXPECT_THAT(samples_of(folder / "a.tif"), ElementsAre(0.0f, 0.2f, 1.0f));
    EXPECT_EQ(read_tiff({folder / "a.tif", ""}).kind, SampleKind::unsigned8);
    recipe.bits = 16;
    for (const char* mode : {"wl", "wb"}) {
        recipe.mode = mode;
        write<std::uint16_t>(folder / "b.tif", recipe, {{0, 13107, 65535}});
        EXPECT_THAT(samples_of(folder / "b.tif"), ElementsAre(0.0f, 0.2f, 1.0f)) << mode;
        EXPECT_EQ(read_tiff({folder / "b.tif", ""}).kind, SampleKind::unsigned16);
    }
}

TEST(TiffFile, ReadsFloats) {
    const TestFolder folder;
    const fs::path path = folder / "a.tif";
    Recipe recipe;
    recipe.samples = 1;
    recipe.width = 4;
    recipe.photometric = PHOTOMETRIC_MINISBLACK;
    recipe.format = SAMPLEFORMAT_IEEEFP;
    for (const char* mode : {"wl", "wb"}) {
        recipe.mode = mode;
        // The smallest half, 1, -infinity and 65504, the largest.
        recipe.bits = 16;
        write<std::uint16_t>(path, recipe, {{0x0001, 0x3c00, 0xfc00, 0x7bff}});
        EXPECT_THAT(samples_of(path), ElementsAre(0x1p-24f, 1.0f, -HUGE_VALF, 65504.0f)) << mode;
        EXPECT_EQ(read_tiff({path, ""}).kind, SampleKind::floating);
        recipe.bits = 32;
        write<float>(path, recipe, {{-2.5f, 7.0f, 1e-30f, 0.1f}});
        EXPECT_THAT(samples_of(path), ElementsAre(-2.5f, 7.0f, 1e-30f, 0.1f)) << mode;
        recipe.bits = 64;
        write<double>(path, recipe, {{-2.5, 7.0, 1e-30, 0.1}});
        EXPECT_THAT(samples_of(path), ElementsAre(-2.5f, 7.0f, 1e-30f, 0.1f)) << mode;
    }
}

TEST(TiffFile, SamplesOfFewBitsReachWhite) {
    const TestFolder folder;
    const fs::path path = folder / "a.tif";
    Recipe recipe;
    recipe.samples = 1;
    recipe.width = 3;
    recipe.photometric = PHOTOMETRIC_MINISBLACK;
    recipe.bits = 1;
    write<std::uint8_t>(path, recipe, {{0b101'00000}});
    EXPECT_THAT(samples_of(path), ElementsAre(1, 0, 1));
    recipe.bits = 12;
    write<std::uint8_t>(path, recipe, {{0x00, 0x03, 0x33, 0xff, 0xf0}});
    EXPECT_THAT(samples_of(path), ElementsAre(0.0f, 0.2f, 1.0f));
    EXPECT_EQ(read_tiff({path, ""}).kind, SampleKind::unsigned16);
}

TEST(TiffFile, ZeroMayBeWhite) {
    const TestFolder folder;
    const fs::path path = folder / "a.tif";
    Recipe recipe;
    recipe.samples = 1;
    recipe.width = 2;
    recipe.photometric = PHOTOMETRIC_MINISWHITE;
    write<std::uint8_t>(path, recipe, {{0, 204}});
    EXPECT_THAT(samples_of(path), ElementsAre(1.0f, 0.2f));
    recipe.bits = 16;
    write<std::uint16_t>(path, recipe, {{0, 52428}});
    EXPECT_THAT(samples_of(path), ElementsAre(1.0f, 0.2f));
}

TEST(TiffFile, PalettesBecomeColours) {
    const TestFolder folder;
    Recipe recipe;
    recipe.samples = 1;
    recipe.width = 3;
    recipe.photometric = PHOTOMETRIC_PALETTE;
    recipe.bits = 4;
    recipe.extras = [](TIFF* tiff) {
        std::array<std::uint16_t, 16> red = {0, 0x3333};
        std::array<std::uint16_t, 16> green = {0, 0x6666};
        std::array<std::uint16_t, 16> blue = {0xffff, 0x9999};
        TIFFSetField(tiff, TIFFTAG_COLORMAP, red.data(), green.data(), blue.data());
    };
    write<std::uint8_t>(folder / "a.tif", recipe, {{0x10, 0x20}});
    EXPECT_THAT(samples_of(folder / "a.tif"), ElementsAre(0.2f, 0.4f, 0.6f, 0, 0, 1, 0, 0, 0));
    EXPECT_EQ(read_tiff({folder / "a.tif", ""}).kind, SampleKind::unsigned8);
}

float sample_at(int x, int y, int c) { return static_cast<float>(100 * y + 10 * x + c); }

// All strips or tiles of the image of sample_at().
std::vector<std::vector<double>> blocks_of(const Recipe& recipe) {
    const bool is_separate = recipe.planes == PLANARCONFIG_SEPARATE;
    const int block_width = recipe.tile > 0 ? recipe.tile : recipe.width;
    const int block_height = recipe.tile > 0 ? recipe.tile : recipe.rows_per_strip;
    std::vector<std::vector<double>> blocks;
    const auto add_block = [&](int plane, int x0, int y0) {
        // A tile is always whole, the last strip is not.
        const int y1 = y0 + block_height;
        std::vector<double>& block = blocks.emplace_back();
        for (int y = y0; y < (recipe.tile > 0 ? y1 : std::min(y1, recipe.height)); ++y) {
            for (int x = x0; x < x0 + block_width; ++x) {
                for (int c = 0; c < (is_separate ? 1 : recipe.samples); ++c) {
                    block.push_back(sample_at(x, y, plane + c));
                }
            }
        }
    };
    for (int plane = 0; plane < (is_separate ? recipe.samples : 1); ++plane) {
        for (int y = 0; y < recipe.height; y += block_height) {
            for (int x = 0; x < recipe.width; x += block_width) add_block(plane, x, y);
        }
    }
    return blocks;
}

TEST(TiffFile, StripsTilesAndPlanesHoldTheSameImage) {
    const TestFolder folder;
    constexpr int kTile = 16;
    Recipe recipe;
    recipe.width = 20;
    recipe.height = 18;
    recipe.bits = 64;
    recipe.format = SAMPLEFORMAT_IEEEFP;
    recipe.rows_per_strip = 5;
    for (const int planes : {PLANARCONFIG_CONTIG, PLANARCONFIG_SEPARATE}) {
        for (const int tile : {0, kTile}) {
            recipe.planes = planes;
            recipe.tile = tile;
            write<double>(folder / "a.tif", recipe, blocks_of(recipe));
            const Image image = read_tiff({folder / "a.tif", ""}).image;
            for (std::size_t i = 0; i < image.data.size(); ++i) {
                const int pixel = static_cast<int>(i) / 3;
                ASSERT_EQ(image.data[i],
                          sample_at(pixel % recipe.width, pixel / recipe.width, int(i % 3)))
                    << planes << " " << tile;
            }
        }
    }
}

TEST(TiffFile, AlphaIsDroppedAndDoesNotScaleColours) {
    const TestFolder folder;
    const fs::path path = folder / "a.tif";
    for (const std::uint16_t alpha : {EXTRASAMPLE_ASSOCALPHA, EXTRASAMPLE_UNASSALPHA}) {
        Recipe recipe;
        recipe.samples = 4;
        recipe.extras = extra_samples({alpha});
        write<std::uint8_t>(path, recipe, {{51, 102, 255, 51}});
        EXPECT_THAT(samples_of(path), ElementsAre(0.2f, 0.4f, 1.0f));
        recipe.samples = 2;
        recipe.photometric = PHOTOMETRIC_MINISBLACK;
        write<std::uint8_t>(path, recipe, {{51, 102}});
        EXPECT_THAT(samples_of(path), ElementsAre(0.2f));
    }
}

TEST(TiffFile, RefusesChannelsItCannotOrder) {
    const TestFolder folder;
    Recipe recipe;
    recipe.photometric = PHOTOMETRIC_MINISBLACK;
    recipe.extras = extra_samples({EXTRASAMPLE_UNSPECIFIED, EXTRASAMPLE_UNASSALPHA});
    write<std::uint8_t>(folder / "a.tif", recipe, {{1, 2, 3}});
    expect_refused(folder / "a.tif", "has the channels R, G, A (expected");
}

TEST(TiffFile, ColoursOfJpegAreRgb) {
    const TestFolder folder;
    constexpr int kSide = 16;
    Recipe recipe;
    recipe.width = kSide;
    recipe.height = kSide;
    recipe.rows_per_strip = kSide;
    recipe.photometric = PHOTOMETRIC_YCBCR;
    recipe.compression = COMPRESSION_JPEG;
    recipe.extras = [](TIFF* tiff) {
        TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    };
    std::vector<std::uint8_t> block;
    for (int i = 0; i < kSide * kSide; ++i) block.insert(block.end(), {200, 100, 50});
    write<std::uint8_t>(folder / "a.tif", recipe, {block});
    const std::vector<float> samples = samples_of(folder / "a.tif");
    constexpr float kTolerance = 3 / 255.0f;  // of a codec that rounds in another colour space
    EXPECT_NEAR(samples.at(0), 200 / 255.0f, kTolerance);
    EXPECT_NEAR(samples.at(1), 100 / 255.0f, kTolerance);
    EXPECT_NEAR(samples.at(2), 50 / 255.0f, kTolerance);
}

TEST(TiffFile, RefusesOtherKindsOfSamples) {
    const TestFolder folder;
    const fs::path path = folder / "a.tif";
    Recipe recipe;
    recipe.format = SAMPLEFORMAT_INT;
    write<std::int8_t>(path, recipe, {{1, 2, 3}});
    expect_refused(path, "has samples of type int8 (expected");
    recipe.format = SAMPLEFORMAT_UINT;
    recipe.bits = 32;
    write<std::uint32_t>(path, recipe, {{1, 2, 3}});
    expect_refused(path, "has samples of type uint (expected");
    recipe.format = SAMPLEFORMAT_COMPLEXIEEEFP;
    recipe.bits = 64;
    write<double>(path, recipe, {{1, 2, 3}});
    expect_refused(path, "has samples of type complex64 (expected");
}

TEST(TiffFile, RefusesOtherColours) {
    const TestFolder folder;
    Recipe recipe;
    recipe.samples = 4;
    recipe.photometric = PHOTOMETRIC_SEPARATED;
    write<std::uint8_t>(folder / "a.tif", recipe, {{1, 2, 3, 4}});
    expect_refused(folder / "a.tif", "has colours of kind 5 (expected a TIFF image of gray, RGB");
}

TEST(TiffFile, RefusesVolumesAndCrops) {
    const TestFolder folder;
    Recipe recipe;
    recipe.extras = [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_IMAGEDEPTH, 2); };
    write<std::uint8_t>(folder / "a.tif", recipe, {{1, 2, 3}});
    expect_refused(folder / "a.tif", "is a deep or volume image (expected a flat image)");
    recipe.extras = [](TIFF* tiff) {
        TIFFSetField(tiff, TIFFTAG_PIXAR_IMAGEFULLWIDTH, 2);
        TIFFSetField(tiff, TIFFTAG_PIXAR_IMAGEFULLLENGTH, 1);
    };
    write<std::uint8_t>(folder / "b.tif", recipe, {{1, 2, 3}});
    expect_refused(folder / "b.tif", "has a data window that is not its display window");
}

TEST(TiffFile, IsAnErrorWhereverItIsCut) {
    const TestFolder folder;
    constexpr int kSide = 16;
    const std::vector<float> block(std::size_t{kSide} * kSide * 3, 0.5f);
    for (const int tile : {0, kSide}) {
        for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW}) {
            Recipe recipe;
            recipe.width = kSide;
            recipe.height = kSide;
            recipe.rows_per_strip = kSide;
            recipe.tile = tile;
            recipe.bits = 32;
            recipe.format = SAMPLEFORMAT_IEEEFP;
            recipe.compression = compression;
            write<float>(folder / "a.tif", recipe, {block});
            const std::string bytes = read_file(folder / "a.tif");
            constexpr std::size_t kNumCuts = 60;
            testing::internal::CaptureStderr();
            for (std::size_t i = 0; i < kNumCuts; ++i) {
                const std::size_t size = (bytes.size() - 1) * i / (kNumCuts - 1);
                write_file(folder / "b.tif", bytes.substr(0, size));
                EXPECT_THROW((void)read_tiff({folder / "b.tif", ""}), Error)
                    << size << " of " << bytes.size() << " bytes";
            }
            EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        }
    }
}

}  // namespace
}  // namespace patina
