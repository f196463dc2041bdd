// Ctrl-C in the middle of the work: status 1, and nothing half-written.
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace patina {
namespace {

namespace fs = std::filesystem;

std::size_t count_entries(const fs::path& folder) {
    return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Starts a simulation that would take hours.
pid_t start_endless_work(const fs::path& output) {
    const std::string target = output.string();
    const pid_t process = fork();
    if (process != 0) return process;
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    execl(PATINA_PROGRAM,
          "patina",
          "simulate",
          "A",
          "--samples",
          "1000000",
          "--lights",
          "25",
          "-o",
          target.c_str(),
          nullptr);
    _exit(127);
}

TEST(ContractInterrupt, LeavesTheOldOutputWholeAndNothingElse) {
    const TestFolder folder;
    const fs::path output = folder / "output";
    fs::create_directory(output);
    write_file(output / "old.txt", "old");
    const pid_t process = start_endless_work(output);
    ASSERT_GT(process, 0);
    // The work has begun once something lies beside the old output.
    int status = 0;
    while (count_entries(folder.path()) < 2 && waitpid(process, &status, WNOHANG) == 0) {
        std::this_thread::yield();
    }
    ASSERT_EQ(count_entries(folder.path()), 2U);
    kill(process, SIGINT);
    ASSERT_EQ(waitpid(process, &status, 0), process);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 1);
    EXPECT_EQ(count_entries(folder.path()), 1U);
    EXPECT_EQ(count_entries(output), 1U);
    EXPECT_EQ(read_file(output / "old.txt"), "old");
}

}  // namespace
}  // namespace patina
