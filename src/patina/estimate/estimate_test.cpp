#include "patina/estimate/estimate.h"

#include "patina/base/error.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace patina {
namespace {

// What validate() says of the defaults with one change; empty when it accepts them.
std::string message_of(const std::function<void(EstimateOptions&)>& change) {
    EstimateOptions options;
    change(options);
    try {
        validate(options);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(EstimateOptions, DefaultsAreValid) {
    EXPECT_EQ(message_of([](EstimateOptions&) {}), "");
}

TEST(EstimateOptions, EachOptionOutOfRangeIsNamed) {
    EXPECT_EQ(message_of([](EstimateOptions& o) { o.photons.photons = 1; }),
              "--photons: is out of range (expected 2 to 1000000000)");
    EXPECT_EQ(message_of([](EstimateOptions& o) { o.photons.photons = 1'000'000'001; }),
              "--photons: is out of range (expected 2 to 1000000000)");
    EXPECT_EQ(message_of([](EstimateOptions& o) { o.max_iterations = 0; }),
              "--iterations: is out of range (expected 1 or more)");
    EXPECT_EQ(message_of([](EstimateOptions& o) { o.threshold = -1; }),
              "--threshold: is out of range (expected 0 or more)");
    EXPECT_EQ(message_of([](EstimateOptions& o) { o.tolerance = 0; }),
              "--tolerance: is out of range (expected a number above 0)");
}

}  // namespace
}  // namespace patina
