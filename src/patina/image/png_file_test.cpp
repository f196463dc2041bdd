#include "patina/image/png_file.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"

#include <gmock/gmock.h>
#include <png.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// How a file is to be written; libpng ends the test where it cannot.
struct Recipe {
    std::uint32_t width = 1;
    int bits = 8;
    int color_type = PNG_COLOR_TYPE_RGB;
    bool interlaced = false;
    // What else goes into the header.
    std::function<void(png_structp, png_infop)> extras = {};
};

// bytes: all rows, as stored.
void write(const fs::path& path, const Recipe& recipe, std::vector<png_byte> bytes) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    const auto header = [&](std::uint32_t height) {
        png_set_IHDR(png,
                     info,
                     recipe.width,
                     height,
                     recipe.bits,
                     recipe.color_type,
                     recipe.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                     PNG_COMPRESSION_TYPE_DEFAULT,
                     PNG_FILTER_TYPE_DEFAULT);
    };
    header(1);
    const std::size_t row_bytes = png_get_rowbytes(png, info);
    header(static_cast<std::uint32_t>(bytes.size() / row_bytes));
    if (recipe.extras) recipe.extras(png, info);
    png_write_info(png, info);
    std::vector<png_bytep> rows;
    for (std::size_t start = 0; start < bytes.size(); start += row_bytes) {
        rows.push_back(&bytes[start]);
    }
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

std::vector<float> samples_of(const fs::path& path) {
    const Image image = read_png({path, ""}).image;
    const ImageSize size = read_png_size({path, ""});
    EXPECT_EQ(image.width, size.width);
    EXPECT_EQ(image.height, size.height);
    EXPECT_EQ(image.channels, size.channels);
    return image.data;
}

TEST(PngFile, AlphaIsDroppedAndDoesNotScaleColours) {
    const TestFolder folder;
    const fs::path path = folder / "a.png";
    Recipe recipe;
    recipe.color_type = PNG_COLOR_TYPE_RGB_ALPHA;
    write(path, recipe, {51, 102, 255, 51});
    EXPECT_THAT(samples_of(path), ElementsAre(0.2f, 0.4f, 1.0f));
    recipe.color_type = PNG_COLOR_TYPE_GRAY_ALPHA;
    write(path, recipe, {51, 102, 255, 51});
    EXPECT_THAT(samples_of(path), ElementsAre(0.2f, 1.0f));
    recipe.bits = 16;
    write(path, recipe, {0x33, 0x33, 0, 1});
    EXPECT_THAT(samples_of(path), ElementsAre(0.2f));
}

TEST(PngFile, GrayOfFewBitsReachesWhite) {
    const TestFolder folder;
    const fs::path path = folder / "a.png";
    Recipe recipe;
    recipe.color_type = PNG_COLOR_TYPE_GRAY;
    recipe.width = 3;
    recipe.bits = 1;
    write(path, recipe, {0b101'00000, 0b010'00000});
    EXPECT_THAT(samples_of(path), ElementsAre(1, 0, 1, 0, 1, 0));
    EXPECT_EQ(read_png({path, ""}).kind, SampleKind::unsigned8);
    recipe.bits = 4;
    write(path, recipe, {0x03, 0xf0});
    EXPECT_THAT(samples_of(path), ElementsAre(0.0f, 0.2f, 1.0f));
}

TEST(PngFile, PalettesBecomeColours) {
    const TestFolder folder;
    const fs::path path = folder / "a.png";
    Recipe recipe;
    recipe.color_type = PNG_COLOR_TYPE_PALETTE;
    recipe.width = 2;
    recipe.bits = 2;
    recipe.extras = [](png_structp png, png_infop info) {
        const std::array<png_color, 3> colors = {{{0, 0, 0}, {51, 102, 153}, {255, 204, 0}}};
        png_set_PLTE(png, info, colors.data(), colors.size());
    };
    const std::vector<png_byte> bytes = {0b01'10'0000};
    write(path, recipe, bytes);
    EXPECT_THAT(samples_of(path), ElementsAre(0.2f, 0.4f, 0.6f, 1.0f, 0.8f, 0.0f));
    const auto opaque = recipe.extras;
    recipe.extras = [&](png_structp png, png_infop info) {
        opaque(png, info);
        const std::array<png_byte, 2> alpha = {255, 7};
        png_set_tRNS(png, info, alpha.data(), alpha.size(), nullptr);
    };
    write(path, recipe, bytes);
    EXPECT_THAT(samples_of(path), ElementsAre(0.2f, 0.4f, 0.6f, 1.0f, 0.8f, 0.0f));
}

TEST(PngFile, InterlacedRowsComeInOrder) {
    const TestFolder folder;
    constexpr std::uint32_t kSide = 11;
    std::vector<png_byte> bytes(std::size_t{kSide} * kSide * 3);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<png_byte>(i * 7);
    Recipe recipe;
    recipe.width = kSide;
    write(folder / "a.png", recipe, bytes);
    recipe.interlaced = true;
    write(folder / "b.png", recipe, bytes);
    EXPECT_EQ(samples_of(folder / "a.png"), samples_of(folder / "b.png"));
    EXPECT_EQ(samples_of(folder / "a.png").at(3), 21 / 255.0f);
}

TEST(PngFile, TakesNoNoticeOfGamma) {
    const TestFolder folder;
    Recipe recipe;
    recipe.extras = [](png_structp png, png_infop info) { png_set_gAMA(png, info, 1.0); };
    write(folder / "a.png", recipe, {51, 102, 255});
    EXPECT_THAT(samples_of(folder / "a.png"), ElementsAre(0.2f, 0.4f, 1.0f));
}

TEST(PngFile, RefusesACrop) {
    const TestFolder folder;
    Recipe recipe;
    recipe.extras = [](png_structp png, png_infop info) {
        png_set_oFFs(png, info, 3, 4, PNG_OFFSET_PIXEL);
    };
    write(folder / "a.png", recipe, {51, 102, 255});
    EXPECT_THAT(
        [&] {
            (void)read_png_size({folder / "a.png", "image"});
        },
        testing::ThrowsMessage<Error>(
            HasSubstr("a.png: image: has a data window that is not its display window")));
}

// What libpng finds wrong in a file whose check sums are right.
TEST(PngFile, RefusesWhatLibpngCannotDecodeInSilence) {
    const TestFolder folder;
    const fs::path path = folder / "a.png";
    Recipe recipe;
    recipe.color_type = PNG_COLOR_TYPE_PALETTE;
    recipe.extras = [](png_structp png, png_infop info) {
        const png_color black = {0, 0, 0};
        png_set_PLTE(png, info, &black, 1);
    };
    write(path, recipe, {0});
    std::string bytes = read_file(path);
    // Length, name, three bytes of colour and check sum.
    constexpr std::size_t kPaletteBytes = 4 + 4 + 3 + 4;
    bytes.erase(bytes.find("PLTE") - 4, kPaletteBytes);
    write_file(path, bytes);
    testing::internal::CaptureStderr();
    EXPECT_THAT(
        [&] {
            (void)read_png({path, ""});
        },
        testing::ThrowsMessage<Error>(HasSubstr("a.png: cannot be read: ")));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace patina
