// Checks for bugs of our own. They print the expression, both values and the place, and abort.
// On in release builds too, outside hot loops. Bad input is patina::Error instead.
#pragma once

#include <fmt/format.h>

#include <string>

namespace patina {

[[noreturn]] void check_failed(const char* file,
                               int line,
                               const char* expression,
                               const std::string& values);

}  // namespace patina

#define PATINA_CHECK(condition)                                                    \
    do {                                                                           \
        if (!(condition)) {                                                        \
            ::patina::check_failed(__FILE__, __LINE__, #condition, std::string()); \
        }                                                                          \
    } while (false)

#define PATINA_CHECK_COMPARE(a, op, b)                                                            \
    do {                                                                                          \
        const auto& patina_check_a = (a);                                                         \
        const auto& patina_check_b = (b);                                                         \
        if (!(patina_check_a op patina_check_b)) {                                                \
            ::patina::check_failed(__FILE__,                                                      \
                                   __LINE__,                                                      \
                                   #a " " #op " " #b,                                             \
                                   fmt::format("{} against {}", patina_check_a, patina_check_b)); \
        }                                                                                         \
    } while (false)

#define PATINA_CHECK_EQ(a, b) PATINA_CHECK_COMPARE(a, ==, b)
#define PATINA_CHECK_LT(a, b) PATINA_CHECK_COMPARE(a, <, b)
#define PATINA_CHECK_LE(a, b) PATINA_CHECK_COMPARE(a, <=, b)
#define PATINA_CHECK_GT(a, b) PATINA_CHECK_COMPARE(a, >, b)
