// The command line of patina: parses with CLI11, runs one command, turns exceptions into one line
// and an exit status.
#include "patina/base/error.h"
#include "patina/base/process_memory.h"
#include "patina/pipeline/version.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.h"
#include <cstdio>
#include <filesystem>
#include <new>

namespace patina {
namespace {

enum ExitStatus : int { kDone = 0, kWorkFailed = 1, kWrongInput = 2 };

int fail(ExitStatus status, const std::string& message) {
    std::fputs(("patina: " + message + "\n").c_str(), stderr);
    return status;
}

std::string command_names(const std::vector<Command>& commands) {
    std::vector<std::string> names;
    for (const Command& command : commands) names.push_back(command.name);
    return join_choices(names);
}

// A word that the parser read, applied once parsing is over, so that our own errors are not the
// parser's.
struct GivenWord {
    const Option* option;
    std::string text;
};

std::string help_text(const Option& option) {
    std::string text = option.help;
    if (!option.range.empty()) text += "; " + option.range;
    if (!option.default_text.empty()) text += " [" + option.default_text + "]";
    if (option.is_required) text += " (required)";
    return text;
}

void add_option(CLI::App& app, const Option& option, std::vector<GivenWord>& given) {
    std::string words = option.flag();
    if (!option.letter.empty()) words = "-" + option.letter + "," + words;
    if (option.kind == OptionKind::flag) {
        app.add_flag_callback(
            words,
            [&option, &given]() {
                given.push_back({&option, ""});
            },
            help_text(option));
        return;
    }
    CLI::callback_t callback = [&option, &given](const CLI::results_t& texts) {
        for (const std::string& text : texts) given.push_back({&option, text});
        return true;
    };
    app.add_option(words, callback, help_text(option))
        ->type_name(option.kind == OptionKind::positional ? "" : option.value_name)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void require_options(const Command& command, const std::vector<GivenWord>& given) {
    for (const Option& option : command.options) {
        const bool was_given = std::any_of(given.begin(), given.end(), [&](const GivenWord& word) {
            return word.option == &option;
        });
        if (option.is_required && !was_given) {
            throw Error(option.flag(), "", "is missing", "for example: " + command.example);
        }
    }
}

int run_command(const Command& command, const CLI::App& app, const std::vector<GivenWord>& given) {
    const std::vector<std::string> unknown = app.remaining();
    if (!unknown.empty()) {
        throw Error(unknown.front(),
                    "",
                    "is not understood",
                    fmt::format("the words that 'patina {} --help' lists", command.name));
    }
    for (const GivenWord& word : given) word.option->set(word.text);
    require_options(command, given);
    command.run();
    return kDone;
}

int run_without_command(const CLI::App& app, const std::vector<Command>& commands) {
    const std::vector<std::string> words = app.remaining();
    if (words.empty()) throw Error("command", "", "is missing", command_names(commands));
    for (const std::string& later : later_commands()) {
        if (words.front() == later) {
            throw Error(later, "", "follows in a later version", command_names(commands));
        }
    }
    throw Error(words.front(), "", "is not a command", command_names(commands));
}

int run(int argc, char** argv) {
    const std::vector<Command> commands = all_commands();
    std::vector<GivenWord> given;
    bool wants_markdown = false;
    CLI::App app("Measures how the surface of a real object reflects light.", "patina");
    app.set_version_flag("--version", "patina " + program_version());
    app.set_help_flag("-h,--help", "Print this help");
    app.add_flag("--help-markdown", wants_markdown, "Print the tables of docs/commands.md");
    app.allow_extras();
    app.footer("Each command explains itself: patina COMMAND --help");
    std::vector<CLI::App*> parsers;
    for (const Command& command : commands) {
        CLI::App* const parser = app.add_subcommand(command.name, command.summary);
        parser->allow_extras();
        parser->footer("Example: " + command.example);
        for (const Option& option : command.options) add_option(*parser, option, given);
        parsers.push_back(parser);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        const std::string what = error.what();
        throw Error("command line", "", what.substr(0, what.find('\n')), "see patina --help");
    }
    if (wants_markdown) {
        std::fputs(commands_markdown().c_str(), stdout);
        return kDone;
    }
    for (std::size_t i = 0; i < commands.size(); ++i) {
        if (parsers[i]->parsed()) return run_command(commands[i], *parsers[i], given);
    }
    return run_without_command(app, commands);
}

}  // namespace
}  // namespace patina

int main(int argc, char** argv) {
    using namespace patina;
    install_interrupt_handler();
    keep_freed_memory();
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        return fail(kWrongInput, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        // Raised where a path cannot even be looked at: too long, or in a folder of another user.
        const Error refused(
            error.path1().string(), "", "is refused: " + error.code().message(), "another path");
        return fail(kWrongInput, refused.what());
    } catch (const WorkFailed& error) {
        return fail(kWorkFailed, error.what());
    } catch (const Interrupted& error) {
        return fail(kWorkFailed, error.what());
    } catch (const std::bad_alloc&) {
        return fail(kWorkFailed, "memory: is used up (expected a machine with more of it)");
    } catch (const std::exception& error) {
        return fail(kWorkFailed, error.what());
    }
}
