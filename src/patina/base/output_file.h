// Outputs that exist whole or not at all: everything is written to a temporary name beside the
// target and renamed at the end.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace patina {

// A folder under construction. commit() moves it to its name, replacing what was there; without
// commit() (an error, Ctrl-C) the destructor removes it and the target stays as it was.
class OutputFolder {
  public:
    // Throws Error when the parent folder does not exist or cannot be written, or when the target
    // exists and is not a folder. option: the option to name in the error, "-o".
    OutputFolder(const std::filesystem::path& target, const std::string& option);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    // Where to write in the meantime.
    [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
    // What it becomes: absolute, and ends with the folder's name, also where "." was given.
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

// A file under construction, likewise. Throws WorkFailed when the disk refuses.
class OutputFile {
  public:
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::span<const std::byte> bytes);
    void commit();

  private:
    [[noreturn]] void fail(const std::string& why) const;

    std::string name_;  // as it was given
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    std::ofstream stream_;
    bool committed_ = false;
};

// Writes one file whole or not at all. Throws WorkFailed when the disk refuses.
void write_file(const std::filesystem::path& target, const std::string& contents);

// Reads a whole file. Throws Error naming the file when it is missing or cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace patina
