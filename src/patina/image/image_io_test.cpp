#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/random.h"
#include "patina/base/test_folder.h"
#include "patina/image/image.h"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// Noise of all sizes and signs, which no codec can shorten much.
Image noise_image(int width, int height, int channels) {
    Image image(width, height, channels);
    Rng rng(1, Pass::tests, 0);
    for (float& value : image.data) value = static_cast<float>(1000 * rng.normal());
    return image;
}

Image unit_noise_image(int width, int height, int channels) {
    Image image(width, height, channels);
    Rng rng(2, Pass::tests, 0);
    for (float& value : image.data) value = static_cast<float>(rng.uniform());
    return image;
}

void expect_same_bits(const Image& a, const Image& b) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    ASSERT_EQ(a.channels, b.channels);
    for (std::size_t i = 0; i < a.data.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(a.data[i]), std::bit_cast<std::uint32_t>(b.data[i]));
    }
}

TEST(ImageIo, ExrReadsBackBitByBit) {
    const TestFolder folder;
    for (const int channels : {1, 3}) {
        Image image = noise_image(37, 21, channels);
        image.data[3] = std::numeric_limits<float>::infinity();
        image.data[4] = std::numeric_limits<float>::quiet_NaN();
        write_exr(folder / "a.exr", image);
        const StoredImage stored = read_image(folder / "a.exr");
        EXPECT_EQ(stored.kind, SampleKind::floating);
        expect_same_bits(stored.image, image);
    }
}

TEST(ImageIo, PfmReadsBackBitByBit) {
    const TestFolder folder;
    for (const int channels : {1, 3}) {
        const Image image = noise_image(5, 4, channels);
        write_pfm(folder / "a.pfm", image);
        const StoredImage stored = read_image(folder / "a.pfm");
        EXPECT_EQ(stored.kind, SampleKind::floating);
        expect_same_bits(stored.image, image);
    }
}

TEST(ImageIo, PfmOfEitherByteOrderHasItsBottomRowFirst) {
    const TestFolder folder;
    write_file(folder / "big.pfm", std::string("Pf\n1 2\n1.0\n\x3f\x80\0\0\x40\0\0\0", 19));
    write_file(folder / "little.pfm", std::string("Pf\n1 2\n-1.0\n\0\0\x80\x3f\0\0\0\x40", 20));
    for (const char* name : {"big.pfm", "little.pfm"}) {
        const Image image = read_image(folder / name).image;
        EXPECT_EQ(image.at(0, 0), 2.0f) << name;
        EXPECT_EQ(image.at(0, 1), 1.0f) << name;
    }
}

TEST(ImageIo, PngRoundsToTheNearestLevel) {
    const TestFolder folder;
    for (const int bits : {8, 16}) {
        const Image image = unit_noise_image(31, 17, 3);
        write_png(folder / "a.png", image, bits);
        const StoredImage stored = read_image(folder / "a.png");
        EXPECT_EQ(stored.kind, bits == 8 ? SampleKind::unsigned8 : SampleKind::unsigned16);
        const float white = bits == 8 ? 255.0f : 65535.0f;
        for (std::size_t i = 0; i < image.data.size(); ++i) {
            ASSERT_EQ(stored.image.data[i], std::round(image.data[i] * white) / white);
        }
    }
}

TEST(ImageIo, PngClampsAndMakesNanBlack) {
    const TestFolder folder;
    Image image(3, 1, 1);
    image.data = {-1.0f, 2.0f, std::numeric_limits<float>::quiet_NaN()};
    write_png(folder / "a.png", image);
    EXPECT_THAT(read_image(folder / "a.png").image.data, testing::ElementsAre(0.0f, 1.0f, 0.0f));
}

TEST(ImageIo, EncodedPngIsTheFile) {
    const TestFolder folder;
    const Image image = unit_noise_image(9, 9, 3);
    write_png(folder / "a.png", image);
    EXPECT_EQ(encode_png(image), read_file(folder / "a.png"));
}

TEST(ImageIo, EqualImagesGiveEqualBytesWithoutDates) {
    const TestFolder folder;
    const Image image = noise_image(40, 40, 3);
    write_exr(folder / "a.exr", image);
    write_exr(folder / "b.exr", image);
    const std::string bytes = read_file(folder / "a.exr");
    EXPECT_EQ(bytes, read_file(folder / "b.exr"));
    for (const char* attribute : {"capDate", "owner", "comments", "Software", "HostComputer"}) {
        EXPECT_THAT(bytes, Not(HasSubstr(attribute)));
    }
}

TEST(ImageIo, SizeComesFromTheHeaderAlone) {
    const TestFolder folder;
    const Image image = unit_noise_image(13, 7, 3);
    write_exr(folder / "a.exr", image);
    write_png(folder / "a.png", image);
    write_pfm(folder / "a.pfm", image);
    for (const char* name : {"a.exr", "a.png", "a.pfm"}) {
        const ImageSize size = read_image_size(folder / name);
        EXPECT_EQ(size.width, 13) << name;
        EXPECT_EQ(size.height, 7) << name;
        EXPECT_EQ(size.channels, 3) << name;
    }
}

TEST(ImageIo, NamesFileAndFieldOfAMissingImage) {
    EXPECT_THAT([] { (void)read_image("no/such.exr", "shots[2].image"); },
                testing::ThrowsMessage<Error>(
                    HasSubstr("no/such.exr: shots[2].image: does not exist (expected an OpenEXR")));
}

// A gray image of one strip that says it has 8 bits a sample. samples: what is there of them.
void write_tiff(const fs::path& path, std::uint32_t side, const std::string& samples) {
    struct Tag {
        std::uint16_t name;
        std::uint16_t type;
        std::uint32_t value;
    };
    constexpr std::uint16_t kShort = 3;
    constexpr std::uint16_t kLong = 4;
    constexpr std::uint32_t kNumTags = 9;
    constexpr std::uint32_t kHeaderBytes = 8 + 2 + 12 * kNumTags + 4;
    const std::array<Tag, kNumTags> tags = {{{256, kLong, side},          // width
                                             {257, kLong, side},          // height
                                             {258, kShort, 8},            // bits per sample
                                             {259, kShort, 1},            // not compressed
                                             {262, kShort, 1},            // black is 0
                                             {273, kLong, kHeaderBytes},  // where the samples begin
                                             {277, kShort, 1},            // channels
                                             {278, kLong, side},          // rows per strip
                                             {279, kLong, side * side}}};  // bytes of the strip
    std::string bytes("II*\0\x08\0\0\0", 8);
    const auto append = [&bytes](std::uint32_t value, int size) {
        for (int k = 0; k < size; ++k) bytes.push_back(static_cast<char>(value >> (8 * k) & 255));
    };
    append(kNumTags, 2);
    for (const Tag& tag : tags) {
        append(tag.name, 2);
        append(tag.type, 2);
        append(1, 4);
        append(tag.value, 4);
    }
    append(0, 4);
    write_file(path, bytes + samples);
}

// A header alone must not fill the memory.
TEST(ImageIo, RefusesSizesBeyondMeasure) {
    const TestFolder folder;
    write_tiff(folder / "a.tif", 32768, "");
    EXPECT_THAT([&] { (void)read_image_size(folder / "a.tif"); },
                testing::ThrowsMessage<Error>(
                    HasSubstr("has a size of 32768 x 32768 (expected at most 536870912 samples)")));
}

TEST(ImageIo, ATiffThatEndsTooEarlyIsAnError) {
    const TestFolder folder;
    const std::string samples("\x33\0\0\xff", 4);
    write_tiff(folder / "a.tif", 2, samples);
    EXPECT_THAT(read_image(folder / "a.tif").image.data, testing::ElementsAre(0.2f, 0, 0, 1));
    write_tiff(folder / "a.tif", 2, samples.substr(0, 3));
    testing::internal::CaptureStderr();
    EXPECT_THAT([&] { (void)read_image(folder / "a.tif"); },
                testing::ThrowsMessage<Error>(HasSubstr("a.tif: is damaged or truncated: ")));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ImageIo, RefusesWhatIsNoImage) {
    const TestFolder folder;
    write_file(folder / "empty.exr", "");
    EXPECT_THAT([&] { (void)read_image(folder / "empty.exr"); },
                testing::ThrowsMessage<Error>(HasSubstr("is empty")));
    write_file(folder / "text.png", "not a picture");
    EXPECT_THAT([&] { (void)read_image(folder / "text.png"); },
                testing::ThrowsMessage<Error>(HasSubstr("is of a kind not understood")));
    EXPECT_THAT([&] { (void)read_image(folder.path()); },
                testing::ThrowsMessage<Error>(HasSubstr("is a folder")));
    write_file(folder / "bad.pfm", "PF\n3 x\n-1.0\n");
    EXPECT_THAT([&] { (void)read_image(folder / "bad.pfm"); },
                testing::ThrowsMessage<Error>(HasSubstr("has no valid PFM header")));
}

class TruncatedImage : public testing::TestWithParam<const char*> {};

// Wherever the file is cut there is an error, never an image with missing parts.
TEST_P(TruncatedImage, IsAnError) {
    const TestFolder folder;
    const std::string name = GetParam();
    const fs::path whole = folder / ("whole." + name);
    const Image image = unit_noise_image(24, 40, 3);
    if (name == "exr") {
        write_exr(whole, image);
    } else if (name == "png") {
        write_png(whole, image);
    } else {
        write_pfm(whole, image);
    }
    const std::string bytes = read_file(whole);
    constexpr std::size_t kNumCuts = 60;
    const fs::path cut = folder / ("cut." + name);
    for (std::size_t i = 0; i < kNumCuts; ++i) {
        const std::size_t size = (bytes.size() - 1) * i / (kNumCuts - 1);
        write_file(cut, bytes.substr(0, size));
        EXPECT_THROW((void)read_image(cut), Error) << size << " of " << bytes.size() << " bytes";
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, TruncatedImage, testing::Values("exr", "png", "pfm"));

class DamagedImage : public testing::TestWithParam<const char*> {};

// Compressed formats carry check sums over their samples: damage is an error or leaves the image
// alone.
TEST_P(DamagedImage, IsAnErrorOrHarmless) {
    const TestFolder folder;
    const std::string name = GetParam();
    const fs::path path = folder / ("a." + name);
    // OpenEXR stores what it cannot shorten as it is, without a check sum: few levels shorten well.
    Image image = unit_noise_image(24, 40, 1);
    for (float& value : image.data) value = std::round(value * 4) / 4;
    name == "exr" ? write_exr(path, image) : write_png(path, image, 16);
    const Image whole = read_image(path).image;
    const std::string bytes = read_file(path);
    constexpr std::size_t kNumPlaces = 60;
    for (std::size_t i = 0; i < kNumPlaces; ++i) {
        // The second half of the file, where there are samples only.
        const std::size_t place = bytes.size() / 2 + bytes.size() / 2 * i / kNumPlaces;
        std::string damaged = bytes;
        damaged[place] = static_cast<char>(~damaged[place]);
        write_file(path, damaged);
        try {
            expect_same_bits(read_image(path).image, whole);
        } catch (const Error&) {
            continue;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedImage, testing::Values("exr", "png"));

}  // namespace
}  // namespace patina
