// Readers of the parts of capture.json, used by description.cpp alone.
#pragma once

#include "patina/capture/capture.h"
#include "patina/capture/json_fields.h"

#include <string>
#include <vector>

namespace patina {

// Largest width or height of an image [pixels].
inline constexpr int kMaxImageSide = 65536;
// Largest width or height of the texel domain: texels are numbered in 32 bits [texels].
inline constexpr int kMaxTexelSide = 32768;
// Most texels of the domain: what a machine can hold some hundred bytes each of [texels].
inline constexpr int kMaxTexels = 1 << 26;

// The path that a field gives, checked: relative, with '/', inside the folder (symbolic links
// followed), an existing file.
[[nodiscard]] std::string read_file_field(const JsonField& field,
                                          const std::filesystem::path& folder);

// The size of the image that a field names; fails unless it has `width` x `height` pixels and one
// or three channels. owner: what the size is that of, for the message.
void check_image_field(const JsonField& field,
                       const std::filesystem::path& folder,
                       int width,
                       int height,
                       const std::string& owner);

// ids: those of a list read before; fails when the field's text is not among them.
[[nodiscard]] std::size_t read_id_field(const JsonField& field,
                                        const std::vector<std::string>& ids,
                                        const std::string& what);

// The sizes of registered cameras are not in their words: the caller sets them.
[[nodiscard]] std::vector<Camera> read_cameras(const JsonField& field);
[[nodiscard]] std::vector<Light> read_lights(const JsonField& field);

// Reads the size of a range image from its file, too.
[[nodiscard]] GeometrySource read_geometry(const JsonField& field,
                                           const std::filesystem::path& folder,
                                           const std::vector<Camera>& cameras);

// Ids of cameras or lights, in their order.
template <typename Item>
[[nodiscard]] std::vector<std::string> ids_of(const std::vector<Item>& items) {
    std::vector<std::string> ids;
    ids.reserve(items.size());
    for (const Item& item : items) ids.push_back(item.id);
    return ids;
}

}  // namespace patina
