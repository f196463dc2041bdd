// Estimates the captures of a folder and writes docs/results.md with its pictures.
#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/parallel.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "pages.h"
#include <cstdio>
#include <exception>

namespace patina {
namespace {

enum ExitStatus : int { kDone = 0, kWorkFailed = 1, kWrongInput = 2 };

struct Words {
    PageSettings settings;
    std::string only;  // empty: all captures
    int threads = 0;   // 0: all of the machine
};

void add_words(CLI::App& app, Words& words) {
    RunSettings& run = words.settings.run;
    app.add_option("CAPTURES", words.settings.captures, "Folder of the captures' folders")
        ->required();
    app.add_option("--docs", words.settings.docs, "Folder for results.md and pictures/");
    app.add_option("--photons", run.photons, "Photons for each set of lamps")
        ->capture_default_str()
        ->check(CLI::Range(2, 1'000'000'000));
    app.add_option("--samples", run.samples, "Paths for each pixel of a held-out shot")
        ->capture_default_str()
        ->check(CLI::Range(1, 65536));
    app.add_option("--seed", run.seed, "Seed of all random numbers")->capture_default_str();
    app.add_option("--threads", words.threads, "Threads to use; 0: all of the machine");
    app.add_option("--only", words.only, "One capture, on standard output and without pictures")
        ->check(CLI::IsMember(section_names()));
}

void run(Words words) {
    const ThreadLimit limit(words.threads);
    Progress progress(Progress::detect(false));
    PageSettings& settings = words.settings;
    if (!words.only.empty()) {
        settings.docs.clear();
        std::fputs(make_section(words.only, settings, progress).c_str(), stdout);
        return;
    }
    if (settings.docs.empty()) throw Error("--docs", "", "is missing", "a folder");
    std::filesystem::create_directories(settings.docs / "pictures");
    std::string page = make_introduction(settings);
    for (const std::string& name : section_names()) {
        page += "\n" + make_section(name, settings, progress);
    }
    write_file(settings.docs / "results.md", page);
    fmt::print("{}\n", (settings.docs / "results.md").string());
}

int fail(ExitStatus status, const std::string& message) {
    std::fputs(("patina_real_captures: " + message + "\n").c_str(), stderr);
    return status;
}

}  // namespace
}  // namespace patina

int main(int argc, char** argv) {
    using namespace patina;
    install_interrupt_handler();
    CLI::App app("What patina makes of real captures.", "patina_real_captures");
    Words words;
    add_words(app, words);
    try {
        app.parse(argc, argv);
        run(words);
        return kDone;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kDone : kWrongInput;
    } catch (const Error& error) {
        return fail(kWrongInput, error.what());
    } catch (const std::exception& error) {
        return fail(kWorkFailed, error.what());
    }
}
