#include "commands.h"

#include "patina/base/parallel.h"
#include "patina/base/progress.h"
#include "patina/pipeline/compare_result.h"
#include "patina/pipeline/demo.h"
#include "patina/pipeline/estimate_capture.h"
#include "patina/pipeline/plan_lamps.h"
#include "patina/pipeline/render_capture.h"
#include "patina/pipeline/show_info.h"
#include "patina/pipeline/simulate_object.h"

#include <fmt/format.h>

#include <cstdio>

namespace patina {
namespace {

namespace fs = std::filesystem;

OptionTable common_option_table(CommonOptions& common) {
    return {
        integer_option("seed", common.seed, at_least(0), "seed of all random numbers"),
        integer_option(
            "threads", common.threads, between(0, 1024), "threads to use; 0: all of the machine"),
        flag_option("quiet", common.quiet, "no progress on standard error"),
        flag_option("json", common.json, "print one JSON object on standard output"),
    };
}

// What every verb needs while it runs.
class Session {
  public:
    explicit Session(const CommonOptions& common)
        : threads_(common.threads), progress(Progress::detect(common.quiet)), json_(common.json) {}

    void print(const std::string& text, const Json& json) const {
        std::fputs(json_ ? to_text(json).c_str() : text.c_str(), stdout);
    }

  private:
    ThreadLimit threads_;

  public:
    Progress progress;

  private:
    bool json_;
};

// A command whose state holds `common` and whatever the options point into.
template <typename State>
Command make_command(const std::string& name,
                     const std::string& summary,
                     const std::string& example,
                     const std::function<OptionTable(State&)>& table,
                     const std::function<void(const State&, Session&)>& work) {
    const auto state = std::make_shared<State>();
    Command command;
    command.name = name;
    command.summary = summary;
    command.example = example;
    command.options = table(*state);
    for (Option& option : common_option_table(state->common)) {
        command.options.push_back(std::move(option));
    }
    command.run = [state, work]() {
        Session session(state->common);
        work(*state, session);
    };
    command.state = state;
    return command;
}

OptionTable joined(OptionTable first, OptionTable second) {
    for (Option& option : second) first.push_back(std::move(option));
    return first;
}

Option output_option(const std::string& value_name, fs::path& field, const std::string& help) {
    return with_letter(required(path_option("output", value_name, field, help)), "o");
}

Command demo_command() {
    struct State {
        CommonOptions common;
        DemoOptions options;
    };
    return make_command<State>(
        "demo",
        "Run the paper's experiments on simulated objects A, B, C and write a report",
        "patina demo -o patina-demo",
        [](State& state) { return demo_option_table(state.options); },
        [](const State& state, Session& session) {
            DemoOptions options = state.options;
            options.seed = state.common.seed;
            const ReportData report = run_demo(options, session.progress);
            session.print(demo_text(report, options), demo_json(report, options));
        });
}

Command info_command() {
    struct State {
        CommonOptions common;
        fs::path path;
        InfoOptions options;
    };
    return make_command<State>(
        "info",
        "Check a capture, a rig or a result and say what is in it",
        "patina info captures/vase -o sheet",
        [](State& state) {
            return joined(
                {positional("PATH", state.path, "the folder of a capture, a rig or a result")},
                info_option_table(state.options));
        },
        [](const State& state, Session& session) {
            const Json info = show_info(state.path, state.options, session.progress);
            session.print(info_text(info), info);
        });
}

Command simulate_command() {
    struct State {
        CommonOptions common;
        std::string object;
        fs::path output;
        SimulateOptions options;
    };
    return make_command<State>(
        "simulate",
        "Take a capture of a known object with the virtual scanner",
        "patina simulate B -o captures/cat",
        [](State& state) {
            return joined({positional("OBJECT", state.object, "A, B, C, V45 or U"),
                           output_option("CAPTURE", state.output, "the folder to write")},
                          simulate_option_table(state.options));
        },
        [](const State& state, Session& session) {
            SimulateOptions options = state.options;
            options.scan.seed = state.common.seed;
            const Json simulated =
                simulate_object(state.object, state.output, options, session.progress);
            session.print(simulate_text(simulated), simulated);
        });
}

Command plan_command() {
    struct State {
        CommonOptions common;
        fs::path path;
        PlanOptions options;
    };
    return make_command<State>(
        "plan",
        "Choose lamp positions from the candidates of a rig or a capture",
        "patina plan rigs/vase -o rigs/chosen",
        [](State& state) {
            return joined({positional("PATH", state.path, "the folder of a rig or a capture")},
                          plan_option_table(state.options));
        },
        [](const State& state, Session& session) {
            const Json plan = plan_lamps(state.path, state.options, session.progress);
            session.print(plan_text(plan), plan);
        });
}

Command render_command() {
    struct State {
        CommonOptions common;
        fs::path capture;
        fs::path result;
        fs::path output;
        ShotRenderOptions options;
    };
    return make_command<State>(
        "render",
        "Render the capture's shots again from the estimated maps",
        "patina render captures/vase results/vase -o renders/vase",
        [](State& state) {
            return joined({positional("CAPTURE", state.capture, "the capture's folder"),
                           positional("RESULT", state.result, "the result's folder"),
                           output_option("DIR", state.output, "the folder to write")},
                          render_option_table(state.options));
        },
        [](const State& state, Session& session) {
            ShotRenderOptions options = state.options;
            options.seed = state.common.seed;
            const Json rendered = render_capture(
                state.capture, state.result, state.output, options, session.progress);
            session.print(render_text(rendered), rendered);
        });
}

Command estimate_command() {
    struct State {
        CommonOptions common;
        fs::path capture;
        fs::path result;
        EstimateOptions options;
    };
    return make_command<State>(
        "estimate",
        "Estimate diffuse, specular and roughness maps, bounced light taken out",
        "patina estimate captures/vase -o results/vase",
        [](State& state) {
            return joined({positional("CAPTURE", state.capture, "the capture's folder"),
                           output_option("RESULT", state.result, "the folder to write")},
                          estimate_option_table(state.options));
        },
        [](const State& state, Session& session) {
            EstimateOptions options = state.options;
            options.photons.seed = state.common.seed;
            const Json result =
                estimate_capture(state.capture, state.result, options, session.progress);
            session.print(estimate_text(result), result);
        });
}

Command compare_command() {
    struct State {
        CommonOptions common;
        fs::path capture;
        fs::path result;
        CompareOptions options;
    };
    return make_command<State>(
        "compare",
        "Compare maps with the images, the held-out shots and, where present, the truth",
        "patina compare captures/vase results/vase --json",
        [](State& state) {
            return joined({positional("CAPTURE", state.capture, "the capture's folder"),
                           positional("RESULT", state.result, "the result's folder")},
                          compare_option_table(state.options));
        },
        [](const State& state, Session& session) {
            CompareOptions options = state.options;
            options.render.seed = state.common.seed;
            const Comparison comparison =
                compare_result(state.capture, state.result, options, session.progress);
            session.print(comparison_text(comparison), comparison_json(comparison));
        });
}

}  // namespace

std::vector<Command> all_commands() {
    return {demo_command(),
            info_command(),
            simulate_command(),
            plan_command(),
            estimate_command(),
            render_command(),
            compare_command()};
}

std::vector<std::string> later_commands() { return {"export", "view", "import"}; }

std::string commands_markdown() {
    std::string text;
    for (const Command& command : all_commands()) {
        text += fmt::format("\n### `patina {}`\n\n{}.\n\n```sh\n{}\n```\n\n{}",
                            command.name,
                            command.summary,
                            command.example,
                            options_markdown(command.options));
    }
    return text;
}

}  // namespace patina
