#include "patina/transport/photon_join.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace patina {
namespace {

// Runs of blocks that are sorted side by side: each takes four bytes per texel, so there are no
// more of them than threads. The result is the same for any number.
constexpr int kMaxRuns = 8;
std::size_t num_runs() { return std::size_t(std::min(kMaxRuns, thread_count())); }

// Joins the blocks in their order and sorts the arrivals by texel: a counting sort whose counts are
// taken for a few runs of blocks apart, so that threads share the work and every arrival has its
// place beforehand.
class BlockJoiner {
  public:
    BlockJoiner(std::vector<PhotonBlock>& blocks, std::size_t num_texels)
        : blocks_(blocks),
          num_texels_(num_texels),
          blocks_per_run_(std::max<std::size_t>(1, (blocks.size() + num_runs() - 1) / num_runs())),
          next_((blocks.size() + blocks_per_run_ - 1) / blocks_per_run_) {}

    [[nodiscard]] PhotonPaths join() {
        place_blocks();
        over_runs([this](std::size_t run, PhotonBlock& block) {
            next_[run].resize(num_texels_);
            for (const PhotonBounce& bounce : block.bounces) {
                next_[run][bounce.to] += bounce.window > 0;
            }
        });
        place_arrivals();
        allocate();
        over_runs([this](std::size_t run, PhotonBlock& block) {
            copy(block, std::size_t(&block - blocks_.data()), next_[run]);
        });
        return std::move(result_);
    }

  private:
    void over_runs(const auto& work) {
        parallel_blocks(blocks_.size(), blocks_per_run_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) work(begin / blocks_per_run_, blocks_[i]);
        });
    }

    void place_blocks() {
        for (const PhotonBlock& block : blocks_) {
            first_path_.push_back(num_paths_);
            first_bounce_.push_back(num_bounces_);
            num_paths_ += block.paths.size();
            num_bounces_ += block.bounces.size();
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

    // Clearing fresh memory costs as much as filling it: the arrays are shared among the threads.
    void allocate() {
        const std::size_t num_arrivals = result_.arrivals_begin.back();
        const std::array<std::function<void()>, 6> tasks = {
            [&] { result_.bounces.resize(num_bounces_); },
            [&] { result_.arrival_direction.resize(num_arrivals); },
            [&] { result_.paths.resize(num_paths_); },
            [&] { result_.arrival_of_bounce.resize(num_bounces_); },
            [&] { result_.arrival_half.resize(num_arrivals); },
            [&] { result_.arrival_position.resize(has_positions_ ? num_arrivals : 0); }};
        parallel_for(
            tasks.size(), [&](std::size_t i) { tasks[i](); }, 1);
    }

    void copy(PhotonBlock& block, std::size_t index, std::vector<std::uint32_t>& next) {
        const std::size_t first = first_bounce_[index];
        for (std::size_t i = 0; i < block.paths.size(); ++i) {
            PhotonPaths::Path& path = result_.paths[first_path_[index] + i];
            path = block.paths[i];
            path.first_bounce += std::uint32_t(first);
        }
        const auto at = std::ptrdiff_t(first);
        std::copy(block.bounces.begin(), block.bounces.end(), result_.bounces.begin() + at);
        // First all places, then all values: memory is asked for them meanwhile.
        for (std::size_t k = 0; k < block.bounces.size(); ++k) {
            const PhotonBounce& bounce = block.bounces[k];
            std::uint32_t& arrival = result_.arrival_of_bounce[first + k];
            arrival = bounce.window > 0 ? next[bounce.to]++ : kNoArrival;
            if (arrival != kNoArrival) __builtin_prefetch(&result_.arrival_direction[arrival], 1);
        }
        for (std::size_t k = 0; k < block.bounces.size(); ++k) {
            const std::uint32_t arrival = result_.arrival_of_bounce[first + k];
            if (arrival == kNoArrival) continue;
            result_.arrival_half[arrival] = block.halves[k];
            result_.arrival_direction[arrival] = block.directions[k];
            if (has_positions_) result_.arrival_position[arrival] = block.positions[k];
        }
        block = PhotonBlock();
    }

    std::vector<PhotonBlock>& blocks_;
    std::size_t num_texels_;
    std::size_t blocks_per_run_;
    std::vector<std::vector<std::uint32_t>> next_;        // per run, per texel
    std::vector<std::size_t> first_path_, first_bounce_;  // per block
    std::size_t num_paths_ = 0;
    std::size_t num_bounces_ = 0;
    bool has_positions_ = false;
    PhotonPaths result_;
};

}  // namespace

PhotonPaths join_blocks(std::vector<PhotonBlock>& blocks, std::size_t num_texels) {
    return BlockJoiner(blocks, num_texels).join();
}

}  // namespace patina
