// Captures of the simulated objects, small enough for a test, and how far an estimate is from their
// truth.
#pragma once

#include "patina/base/test_folder.h"
#include "patina/capture/capture.h"
#include "patina/estimate/estimate.h"
#include "patina/scan/scanner.h"

#include <vector>

namespace patina {

// Rendered once, with sensor noise, into a folder that is gone at the end of the test.
class SimulatedCapture {
  public:
    // lamps: numbers of candidates.
    SimulatedCapture(ObjectKind kind,
                     const std::vector<std::size_t>& lamps,
                     const ScanOptions& options);
    SimulatedCapture(const SimulatedObject& object,
                     const std::vector<std::size_t>& lamps,
                     const ScanOptions& options);
    // Under lamps of one's own, each with an id, seen by the object's first camera; nothing is held
    // out.
    SimulatedCapture(ObjectKind kind, const ScanOptions& options, const std::vector<Light>& lamps);

    [[nodiscard]] Estimate estimate(const EstimateOptions& options) const;

    // Relative error of one channel of Pd in every row of the texel domain, in the mean over the
    // middle half of its columns, where the object's ends do not matter [-].
    [[nodiscard]] std::vector<double> row_errors(const Estimate& estimate, int channel) const;

    // Puts random radiance, up to twice the image's brightest, into so large a share of the pixels
    // of every used shot.
    void spoil(double share);

    [[nodiscard]] const Capture& capture() const { return capture_; }
    [[nodiscard]] const TruthMaps& truth() const { return truth_; }

  private:
    TestFolder folder_;
    Capture capture_;
    TruthMaps truth_;
};

}  // namespace patina
