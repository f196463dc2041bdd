// Where the data lie that some tests need and the project does not carry.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace patina {

// A file or folder below $PATINA_SHARED, or below ../shared beside the checkout. Nothing when it is
// missing: the test is then to be skipped with a message.
[[nodiscard]] inline std::optional<std::filesystem::path> shared_data(const std::string& relative) {
    const char* const variable = std::getenv("PATINA_SHARED");
    const std::filesystem::path folder =
        variable != nullptr ? std::filesystem::path(variable)
                            : std::filesystem::path(PATINA_SOURCE_DIR).parent_path() / "shared";
    const std::filesystem::path path = folder / relative;
    if (!std::filesystem::exists(path)) return std::nullopt;
    return path;
}

}  // namespace patina
