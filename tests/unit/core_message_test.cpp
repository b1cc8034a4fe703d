// Messages: text of any bytes made fit for a terminal.
#include <gtest/gtest.h>

#include <random>

#include "engine/core/message_line.h"

namespace rivulet::core_message_test {
namespace {

size_t charactersIn(const std::string& text) {
    size_t count = 0;
    for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80 ? 1 : 0;
    return count;
}

TEST(MessageLine, PlainTextStays) {
    for (const char* text : {"", "fountain", "a\\b", "caf\xC3\xA9, \xE6\xB0\xB4, \xF0\x9F\x92\xA7", "50 % (\"x\")"}) {
        EXPECT_EQ(printable(text), text);
        EXPECT_EQ(messageLine(text), text);
    }
}

TEST(MessageLine, ControlCharactersAreEscaped) {
    EXPECT_EQ(printable("a\x1b[31mred\x07"), "a\\x1b[31mred\\x07");
    EXPECT_EQ(printable("one\ntwo\tthree\r"), "one\\ntwo\\tthree\\r");
    EXPECT_EQ(printable(std::string("\0\x7f", 2)), "\\x00\\x7f");
    EXPECT_EQ(printable("\xC2\x9B"), "\\u009b") << "the 8-bit form of ESC [";
    EXPECT_EQ(printable("gnp.\xE2\x80\xAE"
                        "eht"),
              "gnp.\\u202eeht")
        << "text that runs backwards";
    EXPECT_EQ(printable("a\xE2\x80\xA8"
                        "b"),
              "a\\u2028b");
}

TEST(MessageLine, BytesThatAreNoTextAreEscaped) {
    EXPECT_EQ(printable("\xFF"), "\\xff");
    EXPECT_EQ(printable("\xC3"), "\\xc3") << "cut off";
    EXPECT_EQ(printable("\xC0\xAF"), "\\xc0\\xaf") << "an overlong form";
    EXPECT_EQ(printable("\xE0\x80\xAF"), "\\xe0\\x80\\xaf");
    EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80") << "half of a surrogate pair";
    EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
    EXPECT_EQ(printable("\xE6\xB0"
                        "a"),
              "\\xe6\\xb0a");
}

TEST(MessageLine, AnyBytesAreOneShortLine) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 3000; ++trial) {
        std::string text(random() % 3000, ' ');
        const bool paths = trial % 2 == 0;
        for (char& c : text) c = paths && random() % 9 == 0 ? '/' : static_cast<char>(random());
        const std::string line = messageLine(text);
        EXPECT_LE(charactersIn(line), kLongestMessage);
        for (const char c : line) ASSERT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F);
        ASSERT_EQ(printable(line), line) << "it is valid text, so that nothing is left to escape";
    }
}

// The folders of a path go first, so that the name of the file and the reason stay.
TEST(MessageLine, LongPathsKeepTheNameOfTheFile) {
    std::string folders = "/home/ada";
    while (folders.size() < 4000) folders += "/folder";
    const std::string line = messageLine(folders + "/pond.json cannot be read: it is a pipe");
    EXPECT_EQ(line, "/home/ada/folder/fol.../pond.json cannot be read: it is a pipe");
    const std::string longName(250, 'n');
    const std::string two =
        messageLine("--save would overwrite " + folders + "/" + longName + ", which is an input (" + folders + "/b.obj)");
    EXPECT_NE(two.find("/" + longName), std::string::npos) << two;
    EXPECT_TRUE(two.ends_with("/b.obj)")) << two;
    EXPECT_LE(two.size(), kLongestMessage);
}

TEST(MessageLine, OtherLongTextIsCutInTheMiddle) {
    const std::string line = messageLine("begin " + std::string(3000, '\xE9') + " end", 60);
    EXPECT_EQ(charactersIn(line), 60U);
    EXPECT_TRUE(line.starts_with("begin \\xe9\\xe9")) << line;
    EXPECT_TRUE(line.ends_with("\\xe9 end")) << line;
    std::string water;
    for (int k = 0; k < 1000; ++k) water += "\xE6\xB0\xB4";
    const std::string cut = messageLine(water, 60);
    EXPECT_EQ(charactersIn(cut), 60U);
    EXPECT_EQ(printable(cut), cut) << "no character is cut";
}

}  // namespace
}  // namespace rivulet::core_message_test
