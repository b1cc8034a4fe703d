// Recording files: the recorded data bit for bit, or an error message, for all file contents.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "engine/core/file.h"
#include "fluid/io/recording.h"
#include "fluid/voxel/packed_array.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::recording_test {
namespace {

constexpr size_t kFrames = 5, kHead = 48;
const std::string kAbout = "name = a pond\n";

std::vector<vec4> noise(std::mt19937& random, size_t count) {
    std::vector<vec4> items(count);
    for (vec4& item : items)
        for (int k = 0; k < 4; ++k) item[k] = std::uniform_real_distribution<float>(-3, 3)(random);
    return items;
}

// Frame k: each another number of everything, and numbers at the limits.
RecordedFrame frameNumber(size_t k) {
    std::mt19937 random(static_cast<unsigned>(k));
    const size_t n = 7 * k;
    RecordedFrame frame;
    frame.time = 0.1 * static_cast<double>(k) / 3;
    frame.spacing = 0.02F;
    frame.halves = k % 2 == 1;
    frame.box.add(vec3(-1, 0, static_cast<float>(k)));
    frame.box.add(vec3(2));
    frame.position = noise(random, n);
    if (n > 0) frame.position[0] = vec4(-1e15F, -0.0F, 1e-42F, std::nextafter(0.1F, 1.0F));
    frame.velocity = noise(random, n);
    for (size_t i = 0; i < n; ++i) frame.id.push_back(static_cast<uint32_t>(random()));
    if (k % 2 == 0) frame.normal = noise(random, n);
    if (k % 3 == 0) frame.absorption = noise(random, n);
    if (k % 2 == 1)
        for (std::vector<vec4>& part : frame.ellipsoids) part = noise(random, n);
    frame.foam = noise(random, k);
    frame.foamVelocity = noise(random, k);
    frame.places.assign(2, mat4(static_cast<float>(k)));
    frame.corners.assign(3, vec3(0.5F, static_cast<float>(k), 0));
    frame.dry.assign(k % 4, {vec4(static_cast<float>(k)), vec4(0.25F), vec4(0, 0, 0, 1)});
    return frame;
}

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same(const RecordedFrame& a, const RecordedFrame& b) {
    bool all = a.time == b.time && a.spacing == b.spacing && a.halves == b.halves && a.box.min == b.box.min && a.box.max == b.box.max;
    for (size_t k = 0; k < a.ellipsoids.size(); ++k) all = all && sameBits(a.ellipsoids[k], b.ellipsoids[k]);
    return all && sameBits(a.position, b.position) && sameBits(a.velocity, b.velocity) && sameBits(a.id, b.id) &&
           sameBits(a.normal, b.normal) && sameBits(a.absorption, b.absorption) && sameBits(a.foam, b.foam) &&
           sameBits(a.foamVelocity, b.foamVelocity) && sameBits(a.places, b.places) && sameBits(a.corners, b.corners) &&
           sameBits(a.dry, b.dry);
}

// The bytes of a recording of kFrames, and where each frame begins.
std::string recorded(const Scratch& scratch, bool closed, std::vector<uint64_t>* offsets = nullptr) {
    const std::string path = scratch.file(closed ? "whole.rrec" : "open.rrec");
    {
        Result<RecordingWriter> writer = RecordingWriter::open(path, kAbout);
        EXPECT_TRUE(writer);
        for (size_t k = 0; k < kFrames; ++k) {
            if (offsets != nullptr) offsets->push_back(writer->bytes());
            EXPECT_TRUE(writer->add(frameNumber(k)));
        }
        EXPECT_EQ(writer->frames(), kFrames);
        if (closed) EXPECT_TRUE(writer->close());
    }
    return readFile(path).value();
}

struct Opened {
    size_t frames = 0;  // 0: it was refused
    std::string said;   // why, or that it is cut off
    size_t whole = 0;   // frames that are what was recorded
    size_t refusedFrames = 0;
    bool wrong = false;  // a frame came back as another
};

// Errors are one sentence that begins with the file's name.
void expectSentence(const std::string& text, const std::string& path) {
    EXPECT_TRUE(text.starts_with(path)) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

Opened opened(const Scratch& scratch, const std::string& bytes) {
    const std::string path = scratch.file("a.rrec");
    std::ofstream(path, std::ios::binary) << bytes;
    Opened out;
    Result<RecordingReader> reader = RecordingReader::open(path);
    if (!reader) {
        expectSentence(reader.error().message, path);
        out.said = reader.error().message;
        return out;
    }
    out.frames = reader->frames();
    out.said = reader->cut();
    if (!out.said.empty()) expectSentence(out.said, path);
    for (size_t k = 0; k < out.frames; ++k) {
        Result<RecordedFrame> frame = reader->read(k, size_t{1} << 24U);
        if (!frame) {
            expectSentence(frame.error().message, path);
            ++out.refusedFrames;
        } else if (k < kFrames && same(*frame, frameNumber(k))) {
            ++out.whole;
        } else {
            out.wrong = true;
        }
    }
    return out;
}

// A recording that is not complete replaces none.
TEST(Recording, AnOlderFileStaysUntilTheNewOneIsComplete) {
    const Scratch scratch;
    const std::string path = scratch.file("a.rrec", "older");
    for (const bool closed : {false, true}) {
        {
            Result<RecordingWriter> writer = RecordingWriter::open(path, kAbout);
            ASSERT_TRUE(writer);
            for (size_t k = 0; k < kFrames; ++k) EXPECT_TRUE(writer->add(frameNumber(k)));
            EXPECT_EQ(readFile(path).value(), "older");
            if (closed) EXPECT_TRUE(writer->close());
        }
        EXPECT_EQ(readFile(path).value() == "older", !closed);
        EXPECT_EQ(scratch.contents(), std::vector<std::string>{"a.rrec"});
    }
    EXPECT_TRUE(readFile(path).value() == recorded(scratch, true));
}

TEST(Recording, GivesBackEachFrameInAnyOrder) {
    const Scratch scratch;
    recorded(scratch, true);
    Result<RecordingReader> reader = RecordingReader::open((scratch.path() / "whole.rrec").string());
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(reader->about(), kAbout);
    EXPECT_EQ(reader->cut(), "");
    ASSERT_EQ(reader->frames(), kFrames);
    for (const size_t k : {3U, 0U, 4U, 4U, 1U, 2U}) {
        Result<RecordedFrame> frame = reader->read(k);
        ASSERT_TRUE(frame) << frame.error().message;
        EXPECT_TRUE(same(*frame, frameNumber(k))) << k;
    }
}

// A killed run or a truncated copy: all complete frames can be read, with a notice.
TEST(Recording, EveryCutLeavesTheFramesBeforeIt) {
    const Scratch scratch;
    std::vector<uint64_t> begins;
    const std::string bytes = recorded(scratch, true, &begins);
    const std::string open = recorded(scratch, false);
    begins.push_back(open.size());
    EXPECT_EQ(bytes.substr(0, open.size()), open);
    for (size_t length = 0; length < bytes.size(); length += length < 400 || length + 100 > bytes.size() ? 1 : 13) {
        const Opened cut = opened(scratch, bytes.substr(0, length));
        size_t expected = 0;
        while (expected < kFrames && begins[expected + 1] <= length) ++expected;
        EXPECT_EQ(cut.frames, expected) << length;
        EXPECT_EQ(cut.whole, expected) << length;
        EXPECT_NE(cut.said, "") << length;
    }
}

// After any bit error, each frame is as recorded or refused.
TEST(Recording, NoFlippedBitPasses) {
    const Scratch scratch;
    const std::string bytes = recorded(scratch, true);
    for (size_t at = 0; at < bytes.size(); at += at < 400 || at + 100 > bytes.size() ? 1 : 11) {
        std::string flipped = bytes;
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
        const Opened found = opened(scratch, flipped);
        EXPECT_FALSE(found.wrong) << at;
        EXPECT_TRUE(!found.said.empty() || found.refusedFrames == 1) << at;
    }
}

// Headers and contents with valid checksums but invalid values, as another program may write them.
TEST(Recording, InvalidFilesAreRefusedWithoutMuchMemory) {
    const Scratch scratch;
    std::vector<uint64_t> begins;
    const std::string bytes = recorded(scratch, true, &begins);
    std::mt19937 random(3);
    const auto sum = [](const std::string& of, size_t from, size_t count) {
        return checksum(std::as_bytes(std::span(of)).subspan(from, count));
    };
    const auto put = [](std::string& into, size_t at, uint64_t number) { std::memcpy(into.data() + at, &number, sizeof(number)); };
    size_t refused = 0;
    for (int trial = 0; trial < 400; ++trial) {
        std::string made = bytes;
        const size_t at = begins[4], packed = begins[4] + kHead;
        uint64_t length = 0;
        std::memcpy(&length, bytes.data() + at + 16, sizeof(length));
        if (trial % 4 == 0)
            put(made, at + 24, uint64_t{1} << (10 + trial % 53));  // how much it unpacks to
        else if (trial % 4 == 1)
            put(made, at + 8, 0x7FF0000000000000U + static_cast<uint64_t>(trial));  // its time
        else
            for (int k = 0; k < 1 + trial % 7; ++k) made[packed + random() % length] = static_cast<char>(random());
        put(made, at + 32, sum(made, packed, length));
        put(made, at + 40, sum(made, at, 40));
        const Opened found = opened(scratch, made);
        EXPECT_EQ(found.frames, kFrames);
        EXPECT_GE(found.whole, kFrames - 1);
        if (trial % 4 < 2) EXPECT_EQ(found.refusedFrames, 1U) << trial;
        refused += found.refusedFrames;
    }
    EXPECT_GT(refused, 220U);  // other numbers in the place of numbers are no nonsense
}

// A forged file may have right checksums: the numbers themselves are checked.
TEST(Recording, NumbersThatCannotBeDrawnAreRefused) {
    const Scratch scratch;
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();
    const std::function<void(RecordedFrame&, float)> places[] = {
        [](RecordedFrame& f, float x) { f.time = x; },
        [](RecordedFrame& f, float x) { f.spacing = x; },
        [](RecordedFrame& f, float x) { f.box.max.y = x; },
        [](RecordedFrame& f, float x) { f.position[3].z = x; },
        [](RecordedFrame& f, float x) { f.velocity[5].x = x; },
        [](RecordedFrame& f, float x) { f.normal.assign(f.position.size(), vec4(x)); },
        [](RecordedFrame& f, float x) { f.absorption.assign(f.position.size(), vec4(0, 0, 0, x)); },
        [](RecordedFrame& f, float x) { f.ellipsoids[2].back().w = x; },
        [](RecordedFrame& f, float x) { f.foam[0].y = x; },
        [](RecordedFrame& f, float x) { f.foamVelocity[0].w = x; },
        [](RecordedFrame& f, float x) { f.places[1][3].x = x; },
        [](RecordedFrame& f, float x) { f.corners[2].z = x; },
    };
    for (size_t k = 0; k < std::size(places); ++k)
        for (const float x : {kNone, kInfinite, -2e15F}) {
            if (k == 0 && std::isfinite(x)) continue;  // a time may be long
            const std::string path = scratch.file("numbers.rrec");
            Result<RecordingWriter> writer = RecordingWriter::open(path, kAbout);
            RecordedFrame frame = frameNumber(1);
            EXPECT_TRUE(writer->add(frame));
            places[k](frame, x);
            EXPECT_TRUE(writer->add(frame));
            EXPECT_TRUE(writer->close());
            Result<RecordingReader> reader = RecordingReader::open(path);
            EXPECT_TRUE(reader->read(0));
            const Result<RecordedFrame> read = reader->read(1);
            ASSERT_FALSE(read) << k << " " << x;
            EXPECT_NE(read.error().message.find("not finite or is beyond 1e15"), std::string::npos) << read.error().message;
        }
}

TEST(Recording, ForeignFilesAreNamed) {
    const Scratch scratch;
    EXPECT_NE(opened(scratch, "").said.find("it is empty"), std::string::npos);
    EXPECT_NE(opened(scratch, "ply\nformat ascii 1.0\n").said.find("not the beginning of a recording"), std::string::npos);
    std::string version = recorded(scratch, true);
    version[12] = 9;
    EXPECT_NE(opened(scratch, version).said.find("its version is 9, this program reads version 1"), std::string::npos);
    const std::string folder = scratch.path().string();
    for (const std::string& path : {folder, folder + "/none.rrec"}) {
        const Result<RecordingReader> reader = RecordingReader::open(path);
        ASSERT_FALSE(reader);
        expectSentence(reader.error().message, path);
    }
    std::mt19937 random(1);
    for (int trial = 0; trial < 200; ++trial) {
        std::string bytes(random() % 400, ' ');
        for (char& c : bytes) c = static_cast<char>(random());
        if (trial % 2 == 0) bytes.insert(0, version, 0, 12);
        EXPECT_EQ(opened(scratch, bytes).frames, 0U);
    }
}

TEST(Recording, AFullDiskIsReported) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    const Result<RecordingWriter> writer = RecordingWriter::open("/dev/full", kAbout);
    ASSERT_FALSE(writer);
    EXPECT_NE(writer.error().message.find("/dev/full: its header cannot be written: the disk is full"), std::string::npos)
        << writer.error().message;
    EXPECT_FALSE(RecordingWriter::open("/dev/null/x.rrec", kAbout));
}

}  // namespace
}  // namespace rivulet::testing::recording_test
