// Whether the bytes of a PNG file are whole, before they go to a decoder that would complain aloud.
//
// Based on: W3C. Portable Network Graphics Specification, Second Edition. 2003, section 5 and annex
// D.
#pragma once

#include <string_view>

namespace patina {

// True when the chunks from the signature to IEND are complete and their check sums right.
[[nodiscard]] bool is_whole_png(std::string_view contents);

}  // namespace patina
