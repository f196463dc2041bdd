#include "patina/base/output_file.h"

#include "patina/base/error.h"
#include "patina/base/test_folder.h"

#include <gmock/gmock.h>

#include <iterator>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

TEST(OutputFolder, LeavesNothingBehindWithoutCommit) {
    const TestFolder folder;
    {
        const OutputFolder output(folder / "result", "-o");
        write_file(output.path() / "a.txt", "a");
    }
    EXPECT_THAT(names_in(folder.path()), IsEmpty());
}

TEST(OutputFolder, AppearsWholeAtCommit) {
    const TestFolder folder;
    OutputFolder output(folder / "result", "-o");
    write_file(output.path() / "a.txt", "a");
    EXPECT_FALSE(fs::exists(folder / "result"));
    output.commit();
    EXPECT_THAT(names_in(folder.path()), ElementsAre("result"));
    EXPECT_EQ(read_file(folder / "result" / "a.txt"), "a");
}

TEST(OutputFolder, ReplacesWhatWasThereAsAWhole) {
    const TestFolder folder;
    fs::create_directory(folder / "result");
    write_file(folder / "result" / "old.txt", "old");
    OutputFolder output(folder / "result", "-o");
    write_file(output.path() / "new.txt", "new");
    output.commit();
    EXPECT_THAT(names_in(folder.path()), ElementsAre("result"));
    EXPECT_THAT(names_in(folder / "result"), ElementsAre("new.txt"));
}

TEST(OutputFolder, KeepsWhatWasThereWithoutCommit) {
    const TestFolder folder;
    fs::create_directory(folder / "result");
    write_file(folder / "result" / "old.txt", "old");
    { const OutputFolder output(folder / "result", "-o"); }
    EXPECT_THAT(names_in(folder.path()), ElementsAre("result"));
    EXPECT_THAT(names_in(folder / "result"), ElementsAre("old.txt"));
}

TEST(OutputFolder, RefusesAFileAsTarget) {
    const TestFolder folder;
    write_file(folder / "result", "a file");
    EXPECT_THROW(OutputFolder(folder / "result", "-o"), Error);
    EXPECT_EQ(read_file(folder / "result"), "a file");
}

TEST(OutputFolder, NamesTheOptionWhenTheNameIsEmpty) {
    EXPECT_THAT([] { const OutputFolder output("", "-o"); },
                testing::ThrowsMessage<Error>(HasSubstr("-o: is empty")));
}

TEST(WriteFile, LeavesOnlyTheTarget) {
    const TestFolder folder;
    write_file(folder / "a.txt", "first");
    write_file(folder / "a.txt", std::string("second\0half", 11));
    EXPECT_THAT(names_in(folder.path()), ElementsAre("a.txt"));
    EXPECT_EQ(read_file(folder / "a.txt"), std::string("second\0half", 11));
}

TEST(WriteFile, FailsWhereTheFolderIsMissing) {
    const TestFolder folder;
    EXPECT_THROW(write_file(folder / "missing" / "a.txt", "a"), WorkFailed);
}

TEST(ReadFile, NamesTheMissingFile) {
    const TestFolder folder;
    EXPECT_THAT([&] { (void)read_file(folder / "none.txt"); },
                testing::ThrowsMessage<Error>(HasSubstr("none.txt: does not exist")));
}

TEST(ReadFile, ReadsAnEmptyFile) {
    const TestFolder folder;
    write_file(folder / "empty", "");
    EXPECT_EQ(read_file(folder / "empty"), "");
}

}  // namespace
}  // namespace patina
