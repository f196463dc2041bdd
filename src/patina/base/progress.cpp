#include "patina/base/progress.h"

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>

namespace patina {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kRedrawInterval = std::chrono::milliseconds(200);

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string human_count(double value) {
    if (value >= 1e9) return fmt::format("{:.1f} G", value / 1e9);
    if (value >= 1e6) return fmt::format("{:.1f} M", value / 1e6);
    if (value >= 1e4) return fmt::format("{:.0f} k", value / 1e3);
    return fmt::format("{:.0f} ", value);
}

std::string human_time(double seconds) {
    if (seconds >= 60) return fmt::format("{}:{:02} min", int(seconds) / 60, int(seconds) % 60);
    return fmt::format("{:.0f} s", seconds);
}

}  // namespace

Progress::Mode Progress::detect(bool quiet) {
    if (quiet) return Mode::quiet;
    return isatty(STDERR_FILENO) != 0 ? Mode::terminal : Mode::plain;
}

Progress::Progress(Mode mode)
    : mode_(mode), stage_start_(Clock::now()), last_drawn_(Clock::now()) {}

Progress::~Progress() { clear_line(); }

void Progress::begin_stage(const std::string& stage, std::uint64_t total, const std::string& unit) {
    end_stage();
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    stage_start_ = Clock::now();
    draw(true);
}

void Progress::advance(std::uint64_t units) {
    const std::lock_guard lock(mutex_);
    done_ += units;
    draw(false);
}

void Progress::end_stage(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (stage_.empty()) return;
    const double seconds = seconds_since(stage_start_);
    bool known = false;
    for (StageTime& time : times_) {
        if (time.stage == stage_) {
            time.seconds += seconds;
            known = true;
        }
    }
    if (!known) times_.push_back({stage_, seconds});
    if (mode_ != Mode::quiet) {
        clear_line();
        const std::string what = message.empty() ? "" : ": " + message;
        std::fputs(fmt::format("{}{} ({:.1f} s)\n", stage_, what, seconds).c_str(), stderr);
    }
    stage_.clear();
}

void Progress::note(const std::string& message) {
    if (mode_ == Mode::quiet) return;
    const std::lock_guard lock(mutex_);
    clear_line();
    std::fputs((message + "\n").c_str(), stderr);
    draw(true);
}

std::vector<StageTime> Progress::stage_times() const {
    const std::lock_guard lock(mutex_);
    return times_;
}

void Progress::draw(bool force) {
    if (mode_ != Mode::terminal || stage_.empty()) return;
    const auto now = Clock::now();
    if (!force && now - last_drawn_ < kRedrawInterval) return;
    last_drawn_ = now;
    std::string line = stage_;
    const double seconds = seconds_since(stage_start_);
    if (total_ > 0 && done_ > 0) {
        const double share = double(done_) / double(total_);
        line += fmt::format("  {:3.0f} %", 100 * share);
        if (!unit_.empty() && seconds > 0) {
            line += fmt::format("  {}{}/s", human_count(double(done_) / seconds), unit_);
        }
        line += fmt::format("  {} left", human_time(seconds * (1 - share) / share));
    }
    std::fputs(("\r\x1b[K" + line).c_str(), stderr);
    std::fflush(stderr);
}

void Progress::clear_line() {
    if (mode_ != Mode::terminal) return;
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
}

}  // namespace patina
