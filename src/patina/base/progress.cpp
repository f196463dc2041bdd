#include "patina/base/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <unistd.h>

namespace patina {
namespace {

constexpr auto kRedrawInterval = std::chrono::milliseconds(200);

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

double Progress::Stage::elapsed() const {
    return seconds + std::chrono::duration<double>(Clock::now() - start).count();
}

Progress::Mode Progress::detect(bool quiet) {
    if (quiet) return Mode::quiet;
    return isatty(STDERR_FILENO) != 0 ? Mode::terminal : Mode::plain;
}

Progress::Progress(Mode mode) : mode_(mode), last_drawn_(Clock::now()) {}

Progress::~Progress() { clear_line(); }

void Progress::begin_stage(const std::string& stage, std::uint64_t total, const std::string& unit) {
    const std::lock_guard lock(mutex_);
    if (!stages_.empty()) stages_.back().seconds = stages_.back().elapsed();
    stages_.push_back({stage, unit, total, 0, 0, Clock::now()});
    draw(true);
}

void Progress::advance(std::uint64_t units) {
    const std::lock_guard lock(mutex_);
    if (!stages_.empty()) stages_.back().done += units;
    draw(false);
}

void Progress::end_stage(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (stages_.empty()) return;
    const std::string name = stages_.back().name;
    const double seconds = stages_.back().elapsed();
    stages_.pop_back();
    if (!stages_.empty()) stages_.back().start = Clock::now();
    const auto time = std::find_if(
        times_.begin(), times_.end(), [&](const StageTime& other) { return other.stage == name; });
    if (time == times_.end()) {
        times_.push_back({name, seconds});
    } else {
        time->seconds += seconds;
    }
    if (mode_ != Mode::quiet) {
        clear_line();
        const std::string what = message.empty() ? "" : ": " + message;
        std::fputs(fmt::format("{}{} ({:.1f} s)\n", name, what, seconds).c_str(), stderr);
    }
    draw(true);
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
    if (mode_ != Mode::terminal || stages_.empty()) return;
    const auto now = Clock::now();
    if (!force && now - last_drawn_ < kRedrawInterval) return;
    last_drawn_ = now;
    const Stage& stage = stages_.back();
    std::string line = stage.name;
    const double seconds = stage.elapsed();
    if (stage.total > 0 && stage.done > 0) {
        const double share = double(stage.done) / double(stage.total);
        line += fmt::format("  {:3.0f} %", 100 * share);
        if (!stage.unit.empty() && seconds > 0) {
            line += fmt::format("  {}{}/s", human_count(double(stage.done) / seconds), stage.unit);
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
