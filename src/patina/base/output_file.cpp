#include "patina/base/output_file.h"

#include "patina/base/error.h"

#include <sstream>
#include <unistd.h>

namespace patina {
namespace {

namespace fs = std::filesystem;

fs::path temporary_beside(const fs::path& target) {
    return target.parent_path() /
           ("." + target.filename().string() + ".partial-" + std::to_string(getpid()));
}

fs::path absolute_target(const fs::path& target) {
    if (target.empty()) return target;
    fs::path path = fs::absolute(target).lexically_normal();
    if (path.filename().empty()) path = path.parent_path();
    return path;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target, const std::string& option)
    : target_(absolute_target(target)) {
    const std::string name = target.string();
    if (name.empty()) throw Error(option, "", "is empty", "the name of a folder to write");
    if (fs::exists(target_) && !fs::is_directory(target_)) {
        throw Error(name, "", "exists and is not a folder", "a new name or a folder to replace");
    }
    std::error_code code;
    fs::create_directories(target_.parent_path(), code);
    temporary_ = temporary_beside(target_);
    fs::remove_all(temporary_, code);
    fs::create_directory(temporary_, code);
    if (code) throw Error(name, "", "cannot be written: " + code.message(), "a writable place");
}

OutputFolder::~OutputFolder() {
    if (committed_) return;
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
}

void OutputFolder::commit() {
    std::error_code code;
    fs::path replaced;
    if (fs::exists(target_)) {
        replaced = temporary_;
        replaced += ".old";
        fs::rename(target_, replaced, code);
        if (code) throw WorkFailed(target_.string() + ": cannot be replaced: " + code.message());
    }
    fs::rename(temporary_, target_, code);
    if (code) {
        std::error_code ignored;
        if (!replaced.empty()) fs::rename(replaced, target_, ignored);
        throw WorkFailed(target_.string() + ": cannot be written: " + code.message());
    }
    committed_ = true;
    if (!replaced.empty()) fs::remove_all(replaced, code);
}

OutputFile::OutputFile(const fs::path& target)
    : name_(target.string()),
      target_(absolute_target(target)),
      temporary_(temporary_beside(target_)),
      stream_(temporary_, std::ios::binary) {
    if (!stream_) fail("");
}

OutputFile::~OutputFile() {
    if (committed_) return;
    stream_.close();
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void OutputFile::fail(const std::string& why) const {
    throw WorkFailed(name_ + ": cannot be written" + why);
}

void OutputFile::write(std::span<const std::byte> bytes) {
    stream_.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    if (!stream_) fail("");
}

void OutputFile::commit() {
    stream_.close();
    if (!stream_) fail("");
    std::error_code code;
    fs::rename(temporary_, target_, code);
    if (code) fail(": " + code.message());
    committed_ = true;
}

void write_file(const fs::path& target, const std::string& contents) {
    OutputFile file(target);
    file.write(std::as_bytes(std::span(contents)));
    file.commit();
}

std::string read_file(const fs::path& path) {
    if (!fs::exists(path)) throw Error(path.string(), "", "does not exist", "a file");
    if (fs::is_directory(path)) throw Error(path.string(), "", "is a folder", "a file");
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream contents;
    contents << stream.rdbuf();
    if (!stream) throw Error(path.string(), "", "cannot be read", "a readable file");
    return contents.str();
}

}  // namespace patina
