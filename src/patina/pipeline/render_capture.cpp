#include "patina/pipeline/render_capture.h"

#include "patina/base/output_file.h"
#include "patina/export/picture.h"
#include "patina/math/statistics.h"
#include "patina/pipeline/text_table.h"

#include <fmt/format.h>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr double kWhiteShare = 0.99;

// The 99th percentile of what shows the surface; 1 where that is black.
double picture_white(const std::vector<RenderedShot>& shots) {
    std::vector<double> values;
    for (const RenderedShot& shot : shots) {
        for (std::size_t i = 0; i < shot.radiance.data.size(); ++i) {
            if (shot.status[i / 3] != 0) values.push_back(double(shot.radiance.data[i]));
        }
    }
    const double white = values.empty() ? 0 : quantile(std::move(values), kWhiteShare);
    return white > 0 ? white : 1;
}

}  // namespace

OptionTable render_option_table(ShotRenderOptions& options) {
    return {integer_option("samples",
                           options.samples_per_pixel,
                           between(1, 1 << 20),
                           "paths for each pixel; powers of two are best")};
}

Json render_capture(const fs::path& capture_path,
                    const fs::path& result_path,
                    const fs::path& output,
                    const ShotRenderOptions& options,
                    Progress& progress) {
    OutputFolder folder(output, "-o");
    progress.begin_stage("read capture and result");
    Capture capture = load_capture(capture_path);
    const Result result = read_result(result_path);
    multiply_lamps(result.lamp_factor, capture.description);
    const ShotRenderer renderer(capture, result.maps, result_path.string());
    progress.end_stage();
    const std::size_t num_shots = capture.description.shots.size();
    std::uint64_t num_paths = 0;
    for (std::size_t i = 0; i < num_shots; ++i) num_paths += renderer.num_paths(i, options);
    progress.begin_stage("render shots", num_paths, "paths");
    std::vector<RenderedShot> shots;
    for (std::size_t i = 0; i < num_shots; ++i) {
        shots.push_back(renderer.render(i, options, progress));
    }
    progress.end_stage(fmt::format("{} shots", num_shots));

    const double white = picture_white(shots);
    Json files = Json::list();
    for (std::size_t i = 0; i < num_shots; ++i) {
        const std::string name = fmt::format("shot{:03}", i);
        write_exr(folder.path() / (name + ".exr"), shots[i].radiance);
        write_png(folder.path() / (name + ".png"), display_image({shots[i].radiance, {}}, white));
        Json item = Json::object();
        item.set("shot", Json(capture.description.shots[i].image));
        item.set("radiance", Json(name + ".exr"));
        item.set("picture", Json(name + ".png"));
        files.push(std::move(item));
    }
    folder.commit();
    Json json = Json::object();
    json.set("name", Json(capture.description.name));
    json.set("folder", Json(output.string()));
    json.set("white", Json(white));
    json.set("shots", std::move(files));
    return json;
}

std::string render_text(const Json& rendered) {
    TextTable table({"shot", "rendered"});
    for (const Json& shot : rendered.find("shots")->items) {
        table.add({shot.find("shot")->text,
                   rendered.find("folder")->text + "/" + shot.find("radiance")->text});
    }
    return table.text();
}

}  // namespace patina
