// Progress of a command: on a terminal one line that is rewritten (stage, share, rate, time left),
// otherwise one line per finished stage. Always on standard error.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace patina {

struct StageTime {
    std::string stage;
    double seconds = 0;  // wall time [s]
};

class Progress {
  public:
    enum class Mode { quiet, plain, terminal };

    // terminal where standard error is one, plain otherwise, quiet on request.
    [[nodiscard]] static Mode detect(bool quiet);

    explicit Progress(Mode mode = Mode::quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // A stage that begins while another runs is a part of that one, which goes on when it ends and
    // does not count its time. total: units of work (0: unknown); unit: what they are, "photons".
    void begin_stage(const std::string& stage,
                     std::uint64_t total = 0,
                     const std::string& unit = "");
    // Adds finished units. May be called from many threads.
    void advance(std::uint64_t units);
    // Ends the innermost stage, if any runs; message is what came out ("262144 texels, 12 shots").
    void end_stage(const std::string& message = "");
    // A remark that a user should read: one line of its own.
    void note(const std::string& message);

    // Stages with the same name are added up, in order of their first end.
    [[nodiscard]] std::vector<StageTime> stage_times() const;

  private:
    using Clock = std::chrono::steady_clock;
    struct Stage {
        std::string name;
        std::string unit;
        std::uint64_t total = 0;
        std::uint64_t done = 0;
        double seconds = 0;       // until a part of it began [s]
        Clock::time_point start;  // or when its last part ended

        [[nodiscard]] double elapsed() const;
    };

    void draw(bool force);
    void clear_line();

    Mode mode_;
    mutable std::mutex mutex_;
    std::vector<Stage> stages_;  // the innermost last
    Clock::time_point last_drawn_;
    std::vector<StageTime> times_;
};

}  // namespace patina
