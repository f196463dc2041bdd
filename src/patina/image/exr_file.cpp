#include "patina/image/exr_file.h"

#include "patina/base/check.h"
#include "patina/base/error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

namespace patina {
namespace {

// The callers have threads of their own.
constexpr int kNoThreads = 0;

// What is read of a file.
struct Selection {
    ImageSize size;
    std::vector<std::string> channels;  // in the order R, G, B or one
};

std::unique_ptr<Imf::MultiPartInputFile> open_exr(const Place& place) {
    try {
        return std::make_unique<Imf::MultiPartInputFile>(place.path.c_str(), kNoThreads);
    } catch (const std::exception& error) {
        place.fail_to_open(error.what());
    }
}

void check_channel(const std::string& name, const Imf::Channel& channel, const Place& place) {
    if (channel.type != Imf::HALF && channel.type != Imf::FLOAT) place.fail_for_type("uint");
    if (channel.xSampling != 1 || channel.ySampling != 1) {
        place.fail("has a sub-sampled channel " + name, "a sample in every pixel");
    }
}

Selection select(const Imf::Header& header, const Place& place) {
    if (header.hasType() && Imf::isDeepData(header.type())) place.fail_for_depth();
    const auto& window = header.dataWindow();
    if (window != header.displayWindow()) place.fail_for_crop();
    std::vector<std::string> names;
    const Imf::ChannelList& channels = header.channels();
    for (auto it = channels.begin(); it != channels.end(); ++it) names.emplace_back(it.name());
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    check_size(width, height, names.size(), place);
    Selection selection;
    for (const int index : wanted_channels(names, place)) {
        const std::string& name = names[std::size_t(index)];
        check_channel(name, channels[name], place);
        selection.channels.push_back(name);
    }
    selection.size = {static_cast<int>(width),
                      static_cast<int>(height),
                      static_cast<int>(selection.channels.size())};
    return selection;
}

// Interleaved samples as slices of a frame buffer, which serves for reading and for writing.
Imf::FrameBuffer frame_of(const float* samples,
                          const std::vector<std::string>& channels,
                          const Imf::Header& header) {
    Imf::FrameBuffer frame;
    const auto& window = header.dataWindow();
    const std::size_t pixel_bytes = channels.size() * sizeof(float);
    const std::size_t row_bytes =
        pixel_bytes * std::size_t(std::int64_t{window.max.x} - window.min.x + 1);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        frame.insert(channels[c],
                     Imf::Slice::Make(Imf::FLOAT, samples + c, window, pixel_bytes, row_bytes));
    }
    return frame;
}

// A file in memory.
class MemoryStream : public Imf::OStream {
  public:
    MemoryStream() : OStream("memory") {}

    void write(const char bytes[], int size) override {
        const std::size_t end = position_ + std::size_t(size);
        if (end > contents_.size()) contents_.resize(end);
        std::memcpy(contents_.data() + position_, bytes, std::size_t(size));
        position_ = end;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    [[nodiscard]] std::string take() { return std::move(contents_); }

  private:
    std::string contents_;
    std::size_t position_ = 0;
};

}  // namespace

Image read_exr(const Place& place) {
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(place);
    const Imf::Header& header = file->header(0);
    const Selection selection = select(header, place);
    Image image(selection.size.width, selection.size.height, selection.size.channels);
    try {
        Imf::InputPart part(*file, 0);
        part.setFrameBuffer(frame_of(image.data.data(), selection.channels, header));
        part.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    } catch (const std::exception& error) {
        place.fail_as_damaged(error.what());
    }
    return image;
}

ImageSize read_exr_size(const Place& place) {
    return select(open_exr(place)->header(0), place).size;
}

std::string encode_exr(const Image& image) {
    PATINA_CHECK(image.channels == 1 || image.channels == 3);
    const std::vector<std::string> channels = image.channels == 3
                                                  ? std::vector<std::string>{"R", "G", "B"}
                                                  : std::vector<std::string>{"Y"};
    try {
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        for (const std::string& name : channels) {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        }
        MemoryStream stream;
        {
            Imf::OutputFile file(stream, header, kNoThreads);
            file.setFrameBuffer(frame_of(image.data.data(), channels, header));
            file.writePixels(image.height);
        }
        return stream.take();
    } catch (const std::exception& error) {
        throw WorkFailed(fmt::format("cannot encode an image as exr: {}", error.what()));
    }
}

}  // namespace patina
