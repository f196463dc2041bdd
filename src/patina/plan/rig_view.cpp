#include "patina/plan/rig_view.h"

#include "patina/base/error.h"

#include <algorithm>

namespace patina {

RigView::RigView(const Capture& capture, Progress& progress)
    : capture_(&capture), tracer_(capture.mesh) {
    progress.begin_stage("views", capture.description.cameras.size(), "cameras");
    for (const Camera& camera : capture.description.cameras) {
        views_.push_back(views_of(camera));
        progress.advance(1);
    }
    for (std::size_t i = 0; i < capture.atlas.texels.size(); ++i) {
        if (std::any_of(views_.begin(), views_.end(), [i](const auto& view) {
                return view[i].state != ViewState::hidden;
            })) {
            seen_.push_back(TexelId(i));
        }
    }
    if (seen_.empty()) {
        throw Error(
            capture.description.file.string(), "cameras", "see no texel", "a view of the surface");
    }
    progress.end_stage(std::to_string(seen_.size()) + " texels seen");
}

std::vector<TexelView> RigView::views_of(const Camera& camera) const {
    return view_texels(capture_->mesh, tracer_, capture_->atlas, camera);
}

LargeVector<DirectLight> RigView::direct(const Light& light) const {
    return direct_light({&capture_->mesh, &tracer_}, capture_->atlas, light);
}

bool is_usable(const DirectLight& direct, const TexelView& view, const LookLimits& limits) {
    return direct.state == ShadowState::lit && view.state == ViewState::clear &&
           direct.cos_i > limits.min_cos_i && view.cos_v > limits.min_cos_v;
}

bool may_go_together(const Camera& camera, const Light& light) {
    return light.frame == FrameOfReference::world || camera.frame == FrameOfReference::scanner;
}

std::vector<std::size_t> candidate_lights(const CaptureDescription& description,
                                          std::span<const std::size_t> taken) {
    std::vector<std::uint8_t> is_used(description.lights.size(), 0);
    std::vector<std::uint8_t> is_heldout(description.lights.size(), 0);
    for (const Shot& shot : description.shots) {
        for (const std::size_t light : shot.lights) {
            (shot.heldout ? is_heldout : is_used)[light] = 1;
        }
    }
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < is_used.size(); ++i) {
        const bool is_taken = std::find(taken.begin(), taken.end(), i) != taken.end();
        if (!is_taken && (is_used[i] != 0 || is_heldout[i] == 0)) candidates.push_back(i);
    }
    if (candidates.empty()) {
        throw Error(description.file.string(), "lights", "hold no candidate", "at least one");
    }
    return candidates;
}

}  // namespace patina
