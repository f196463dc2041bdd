#include "patina/transport/photon_join.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <utility>

namespace patina {
namespace {

// Runs of blocks that are sorted side by side: each takes four bytes per texel, so there are no
// more of them than threads. The result is the same for any number.
constexpr int kMaxRuns = 8;

// Joins the blocks in their order and sorts the arrivals by texel: a counting sort whose counts are
// taken for a few runs of blocks apart, so that threads share the work and every arrival has its
// place beforehand.
class BlockJoiner {
  public:
    BlockJoiner(std::span<const PhotonBlock> blocks, std::size_t num_texels)
        : blocks_(blocks),
          num_texels_(num_texels),
          next_(std::size_t(std::min(kMaxRuns, thread_count()))) {}

    [[nodiscard]] PhotonPaths join() {
        place_blocks();
        for (std::vector<std::uint32_t>& counts : next_) counts.resize(num_texels_);
        over_runs([this](std::size_t run, std::size_t block) {
            for (const PhotonArrival& arrival : blocks_[block].arrivals) {
                next_[run][arrival.bounce.to] += arrival.bounce.window > 0;
            }
        });
        place_arrivals();
        allocate();
        over_runs([this](std::size_t run, std::size_t block) { copy(block, next_[run]); });
        return std::move(result_);
    }

  private:
    void over_runs(const auto& work) {
        parallel_for(
            next_.size(),
            [&](std::size_t run) {
                const std::size_t end = run_begin(run + 1);
                for (std::size_t block = run_begin(run); block < end; ++block) work(run, block);
            },
            1);
    }
    // The first block of a run: all runs have about as many bounces.
    [[nodiscard]] std::size_t run_begin(std::size_t run) const {
        if (run == next_.size()) return blocks_.size();
        const auto wanted = num_bounces_ * run / next_.size();
        return std::size_t(std::lower_bound(first_bounce_.begin(), first_bounce_.end(), wanted) -
                           first_bounce_.begin());
    }

    void place_blocks() {
        for (const PhotonBlock& block : blocks_) {
            first_path_.push_back(num_paths_);
            first_bounce_.push_back(num_bounces_);
            num_paths_ += block.paths.size();
            num_bounces_ += block.arrivals.size();
            result_.rays += block.rays;
            has_positions_ = has_positions_ || !block.positions.empty();
        }
        PATINA_CHECK_LT(num_bounces_, std::size_t{kNoArrival});
    }

    // Turns the runs' counts into their first arrivals.
    void place_arrivals() {
        result_.arrivals_begin.resize(num_texels_ + 1);
        std::uint32_t arrival = 0;
        for (std::size_t texel = 0; texel < num_texels_; ++texel) {
            result_.arrivals_begin[texel] = arrival;
            for (std::vector<std::uint32_t>& next : next_) {
                arrival += std::exchange(next[texel], arrival);
            }
        }
        result_.arrivals_begin[num_texels_] = arrival;
    }

    void allocate() {
        const std::size_t num_arrivals = result_.arrivals_begin.back();
        result_.paths.resize(num_paths_);
        result_.bounces.resize(num_bounces_);
        result_.arrival_of_bounce.resize(num_bounces_);
        result_.arrival_half.resize(num_arrivals);
        result_.arrival_direction.resize(num_arrivals);
        result_.arrival_position.resize(has_positions_ ? num_arrivals : 0);
    }

    void copy(std::size_t index, std::vector<std::uint32_t>& next) {
        const PhotonBlock& block = blocks_[index];
        const std::size_t first = first_bounce_[index];
        for (std::size_t i = 0; i < block.paths.size(); ++i) {
            PhotonPaths::Path& path = result_.paths[first_path_[index] + i];
            path = block.paths[i];
            path.first_bounce += std::uint32_t(first);
        }
        // First all places, then all values: memory is asked for them meanwhile.
        for (std::size_t k = 0; k < block.arrivals.size(); ++k) {
            const PhotonBounce& bounce = block.arrivals[k].bounce;
            result_.bounces[first + k] = bounce;
            std::uint32_t& arrival = result_.arrival_of_bounce[first + k];
            arrival = bounce.window > 0 ? next[bounce.to]++ : kNoArrival;
            if (arrival != kNoArrival) __builtin_prefetch(&result_.arrival_direction[arrival]);
        }
        for (std::size_t k = 0; k < block.arrivals.size(); ++k) {
            const std::uint32_t arrival = result_.arrival_of_bounce[first + k];
            if (arrival == kNoArrival) continue;
            result_.arrival_half[arrival] = block.arrivals[k].half;
            result_.arrival_direction[arrival] = block.arrivals[k].direction;
            if (has_positions_) result_.arrival_position[arrival] = block.positions[k];
        }
    }

    std::span<const PhotonBlock> blocks_;
    std::size_t num_texels_;
    std::vector<std::vector<std::uint32_t>> next_;        // per run, per texel
    std::vector<std::size_t> first_path_, first_bounce_;  // per block
    std::size_t num_paths_ = 0;
    std::size_t num_bounces_ = 0;
    bool has_positions_ = false;
    PhotonPaths result_;
};

}  // namespace

PhotonPaths join_blocks(std::span<const PhotonBlock> blocks, std::size_t num_texels) {
    return BlockJoiner(blocks, num_texels).join();
}

}  // namespace patina
