#include "picture_sheet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "map_pictures.h"

namespace patina {
namespace {

class PictureSheet {
  public:
    PictureSheet(const std::string& name, const Capture& capture, const std::filesystem::path& docs)
        : name_(name), atlas_(capture.atlas), docs_(docs) {}

    [[nodiscard]] std::string write(const MethodRun& direct, const MethodRun& gather) {
        const auto diffuse_known = [&](TexelId t) { return is_diffuse_measured(gather, t); };
        const auto diffuse_of = [](const MethodRun& run) {
            return [&run](TexelId t) { return mean_diffuse(run, t); };
        };
        const ColorRange range = range_from_zero(atlas_, diffuse_known, diffuse_of(direct));
        write_map_picture(file("pd_direct"), atlas_, range, diffuse_known, diffuse_of(direct));
        add("Pd by direct, " + range.text);
        write_map_picture(file("pd_gather"), atlas_, range, diffuse_known, diffuse_of(gather));
        add("Pd by gather, " + range.text);
        write_ratio_picture(
            file("pd_ratio"),
            atlas_,
            [&](TexelId t) {
                return diffuse_known(t) && mean_diffuse(direct, t) > 0 &&
                       mean_diffuse(gather, t) > 0;
            },
            [&](TexelId t) { return mean_diffuse(gather, t) / mean_diffuse(direct, t); });
        add("gather over direct, " + ratio_range().text);
        write_lobe(gather);
        write_status_picture(file("status"), atlas_, gather.estimate);
        add("status by gather: 1 at the bar's top, 2, 3 at its bottom");
        return table_head(captions_) + table_row(pictures_);
    }

  private:
    void write_lobe(const MethodRun& gather) {
        const auto lobe_known = [&](TexelId t) { return is_diffuse_measured(gather, t); };
        const auto specular = [&](TexelId t) { return gather.estimate.maps[t].specular; };
        const auto roughness = [&](TexelId t) { return gather.estimate.maps[t].roughness; };
        const ColorRange specular_range = range_from_zero(atlas_, lobe_known, specular);
        write_map_picture(file("ps"), atlas_, specular_range, lobe_known, specular);
        add("Ps by gather, " + specular_range.text);
        const ColorRange roughness_range = range_from_zero(atlas_, lobe_known, roughness);
        write_map_picture(file("sigma"), atlas_, roughness_range, lobe_known, roughness);
        add("sigma by gather, " + roughness_range.text + " rad");
    }

    // The picture to write next.
    [[nodiscard]] std::filesystem::path file(const std::string& map) {
        const std::string picture = fmt::format("pictures/{}_{}.png", name_, map);
        next_picture_ = picture;
        return docs_ / picture;
    }
    void add(const std::string& caption) {
        captions_.push_back(caption);
        pictures_.push_back(fmt::format("![{}]({})", caption, next_picture_));
    }

    std::string name_;
    const TexelAtlas& atlas_;
    std::filesystem::path docs_;
    std::string next_picture_;
    std::vector<std::string> captions_;
    std::vector<std::string> pictures_;
};

}  // namespace

std::string table_row(const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string table_head(const std::vector<std::string>& cells) {
    return table_row(cells) + table_row(std::vector<std::string>(cells.size(), "---"));
}

std::string write_pictures(const std::string& name,
                           const Capture& capture,
                           const std::filesystem::path& docs,
                           const MethodRun& direct,
                           const MethodRun& gather) {
    if (docs.empty()) return "";
    return PictureSheet(name, capture, docs).write(direct, gather);
}

}  // namespace patina
