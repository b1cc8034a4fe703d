// .rvox files: a file reads back exactly, and any other bytes give an error.
#include "fluid/voxel/voxel_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "fluid/voxel/packed_array.h"
#include "tests/unit/program_runner.h"

namespace rivulet::voxel_file_test {
namespace {

constexpr size_t kHeaderBytes = 80, kSectionBytes = 40;

// Labels from a function of the voxel, counted voxel by voxel.
template <class Fn>
VoxelLabels labelsOf(const ivec3& size, float edge, uint32_t materials, const Fn& labelAt) {
    VoxelLabels l;
    l.size = size;
    l.materials.resize(materials);
    for (VoxelMaterial& m : l.materials) {
        m.low = size;
        m.high = ivec3(-1);
    }
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            l.rowStart.push_back(static_cast<uint32_t>(l.runs.size()));
            for (int x = 0; x < size.x; ++x) {
                const uint32_t label = labelAt(ivec3(x, y, z));
                if (x == 0 || l.runs.back().label != label) l.runs.push_back({static_cast<uint32_t>(x), label});
                if (label == kOutside) ++l.outside;
                if (label == kInsideSurface) ++l.surface;
                if (label < kFirstMaterial) continue;
                VoxelMaterial& m = l.materials[label - kFirstMaterial];
                ++m.voxels;
                m.low = glm::min(m.low, ivec3(x, y, z));
                m.high = glm::max(m.high, ivec3(x, y, z));
            }
        }
    }
    l.rowStart.push_back(static_cast<uint32_t>(l.runs.size()));
    for (VoxelMaterial& m : l.materials) {
        m.volume = static_cast<double>(m.voxels) * static_cast<double>(edge) * static_cast<double>(edge) * static_cast<double>(edge);
        m.solid = m.voxels % 2 == 0;
    }
    return l;
}

// Noise of every sort, with each label used at least once.
VoxelFile makeFile(unsigned seed, const ivec3& size, bool labels, bool band) {
    std::mt19937 random(seed);
    VoxelFile f;
    f.mode = static_cast<VoxelMode>(seed % 3);
    f.bits.size = size;
    f.bits.origin = vec3(-0.125F, 3e-7F, 1e6F);
    f.bits.voxel = 0.0123F;
    f.bits.bits.assign((f.bits.count() + 31) / 32 * 4, 0);
    const auto forEach = [&size](const auto& body) {
        for (int z = 0; z < size.z; ++z)
            for (int y = 0; y < size.y; ++y)
                for (int x = 0; x < size.x; ++x) body(ivec3(x, y, z));
    };
    forEach([&](const ivec3& c) {
        if (random() % 3 == 0) f.bits.set(c);
    });
    if (labels) {
        const auto materials = static_cast<uint32_t>(std::min<size_t>(3, f.bits.count() / 4));
        uint32_t next = kFirstMaterial;
        f.labels = labelsOf(size, f.bits.voxel, materials, [&](const ivec3&) {
            return next < kFirstMaterial + materials ? next++ : static_cast<uint32_t>(random() % (kFirstMaterial + materials));
        });
    }
    if (band) {
        VoxelBand& b = f.band.emplace();
        b.band = 0.05F;
        const size_t points = static_cast<size_t>(size.x + 1) * static_cast<size_t>(size.y + 1) * static_cast<size_t>(size.z + 1);
        b.closed = seed % 2 == 1;
        std::uniform_real_distribution<float> distance(b.closed ? -b.band : 0.0F, b.band);
        for (size_t k = 0; k < points; ++k) {
            b.distance.push_back(k % 5 == 0 ? b.band : distance(random));
            b.normal.push_back(static_cast<uint32_t>(random()));
        }
    }
    if (seed % 2 == 0) f.key = std::string("a key, with \0 in it", 19);
    return f;
}

void expectSame(const VoxelFile& a, const VoxelFile& b) {
    EXPECT_EQ(a.mode, b.mode);
    EXPECT_EQ(a.bits.size, b.bits.size);
    EXPECT_EQ(a.bits.origin, b.bits.origin);
    EXPECT_EQ(a.bits.voxel, b.bits.voxel);
    EXPECT_EQ(a.key, b.key);
    EXPECT_TRUE(a.bits.bits == b.bits.bits);
    ASSERT_EQ(a.labels.has_value(), b.labels.has_value());
    if (a.labels) {
        EXPECT_EQ(a.labels->size, b.labels->size);
        EXPECT_TRUE(a.labels->rowStart == b.labels->rowStart);
        EXPECT_TRUE(std::equal(a.labels->runs.begin(), a.labels->runs.end(), b.labels->runs.begin(), b.labels->runs.end(),
                               [](const LabelRun& p, const LabelRun& q) { return p.x == q.x && p.label == q.label; }));
        EXPECT_EQ(a.labels->outside, b.labels->outside);
        EXPECT_EQ(a.labels->surface, b.labels->surface);
        ASSERT_EQ(a.labels->materials.size(), b.labels->materials.size());
        for (size_t k = 0; k < a.labels->materials.size(); ++k) {
            const VoxelMaterial &p = a.labels->materials[k], &q = b.labels->materials[k];
            EXPECT_TRUE(p.voxels == q.voxels && p.volume == q.volume && p.low == q.low && p.high == q.high && p.solid == q.solid) << k;
        }
    }
    ASSERT_EQ(a.band.has_value(), b.band.has_value());
    if (!a.band) return;
    EXPECT_EQ(a.band->band, b.band->band);
    EXPECT_EQ(a.band->closed, b.band->closed);
    EXPECT_TRUE(a.band->distance == b.band->distance);
    EXPECT_TRUE(a.band->normal == b.band->normal);
}

std::span<const std::byte> bytesOf(const std::string& text) { return std::as_bytes(std::span(text)); }

Result<VoxelFile> unpack(const std::string& bytes, size_t limit = size_t{1} << 30U) {
    return unpackVoxelFile(bytesOf(bytes), "some.rvox", limit);
}

std::string packed(const VoxelFile& file) {
    Result<std::string> bytes = packVoxelFile(file);
    return bytes ? *bytes : "";
}

std::string errorOf(const Result<VoxelFile>& result) { return result ? "" : result.error().message; }

template <class T>
T valueAt(const std::string& bytes, size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

template <class T>
void setAt(std::string& bytes, size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

// Makes all checksums right, as an attacker would: the checks after them must suffice.
void seal(std::string& bytes) {
    if (bytes.size() < kHeaderBytes) return;
    const auto sections = std::min<size_t>(valueAt<uint32_t>(bytes, 20), (bytes.size() - kHeaderBytes) / kSectionBytes);
    for (size_t k = 0; k < sections; ++k) {
        const size_t row = kHeaderBytes + k * kSectionBytes;
        const auto offset = valueAt<uint64_t>(bytes, row + 8), length = valueAt<uint64_t>(bytes, row + 16);
        if (offset <= bytes.size() && length <= bytes.size() - offset) setAt(bytes, row + 32, XXH3_64bits(bytes.data() + offset, length));
    }
    const std::string head = bytes.substr(0, 72) + bytes.substr(kHeaderBytes, sections * kSectionBytes);
    setAt(bytes, 72, XXH3_64bits(head.data(), head.size()));
}

// A forged file: given sections, with everything around them correct.
struct Forgery {
    struct Part {
        uint32_t kind;
        uint64_t bytes;  // claimed
        std::string packed;
    };
    ivec3 size{4, 2, 2};
    float voxel = 0.5F, band = 0;
    uint32_t closed = 0;
    std::vector<Part> parts;

    template <class... T>
    void add(uint32_t kind, const std::vector<T>&... arrays) {
        Part part{kind, ((arrays.size() * sizeof(T)) + ...), {}};
        ArrayPacker packer(part.packed);
        (packer.put(std::span<const T>(arrays)), ...);
        packer.finish();
        parts.push_back(part);
    }
    std::string bytes() const {
        std::string out("\x89RVOX\r\n\x1A", 8);
        const auto put = [&out](auto value) { out.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
        for (uint32_t v : {0x01020304U, 1U, 1U, static_cast<uint32_t>(parts.size())}) put(v);
        for (int v : {size.x, size.y, size.z}) put(v);
        for (float v : {0.0F, 0.0F, 0.0F, voxel, band}) put(v);
        uint64_t at = kHeaderBytes + parts.size() * kSectionBytes, end = at;
        for (const Part& part : parts) end += part.packed.size();
        put(closed);
        put(0U);
        for (uint64_t v : {end, uint64_t{0}}) put(v);
        for (const Part& part : parts) {
            put(part.kind);
            put(0U);
            for (uint64_t v : {at, uint64_t{part.packed.size()}, part.bytes, uint64_t{0}}) put(v);
            at += part.packed.size();
        }
        for (const Part& part : parts) out += part.packed;
        seal(out);
        return out;
    }
};

struct Record {
    uint64_t voxels;
    double volume;
    int32_t low[3], high[3];
    uint32_t solid = 1, zero = 0;
};
using Words = std::vector<uint32_t>;
using Bytes = std::vector<uint8_t>;

// 4 x 2 x 2 voxels: row (y=0, z=0) is outside, surface, material, material; the others are outside.
Forgery forgedLabels(const Words& counts = {3, 1, 1, 1}, const Words& x = {0, 1, 2, 0, 0, 0}, const Words& label = {0, 1, 2, 0, 0, 0},
                     const std::vector<Record>& records = {{2, 0.25, {2, 0, 0}, {3, 0, 0}}}) {
    Forgery f;
    f.add(1, Bytes{0x0E, 0, 0, 0});
    f.add(2, counts, x, label);
    f.add(3, records);
    return f;
}

TEST(VoxelFile, ReadsBackAWrittenFile) {
    unsigned seed = 0;
    for (const ivec3& size : {ivec3(1, 1, 1), ivec3(7, 5, 3), ivec3(33, 17, 9), ivec3(64, 40, 24)}) {
        for (int which = 0; which < 4; ++which) {
            const VoxelFile file = makeFile(seed++, size, (which & 1) != 0, (which & 2) != 0);
            const Result<VoxelFile> again = unpack(packed(file));
            ASSERT_TRUE(again) << again.error().message;
            expectSame(file, *again);
        }
    }
}

// More than a block of every array, so that blocks meet.
TEST(VoxelFile, LargeGridsToo) {
    const VoxelFile file = makeFile(7, ivec3(150, 90, 60), true, true);
    const Result<VoxelFile> again = unpack(packed(file));
    ASSERT_TRUE(again) << again.error().message;
    expectSame(file, *again);
}

TEST(VoxelFile, ThroughTheDisk) {
    testing::Scratch scratch;
    const std::string path = scratch.file("a.rvox");
    const VoxelFile file = makeFile(4, ivec3(20, 21, 22), true, true);
    const Result<size_t> written = writeVoxelFile(path, file);
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(*written, std::filesystem::file_size(path));
    const Result<VoxelFile> again = readVoxelFile(path);
    ASSERT_TRUE(again) << again.error().message;
    expectSame(file, *again);
    EXPECT_EQ(scratch.contents(), std::vector<std::string>{"a.rvox"});

    const Result<size_t> nowhere = writeVoxelFile(scratch.file("none/a.rvox"), file);
    ASSERT_FALSE(nowhere);
    EXPECT_NE(nowhere.error().message.find("none/a.rvox"), std::string::npos);
    EXPECT_EQ(nowhere.error().fault, Fault::failed);
    EXPECT_FALSE(readVoxelFile(scratch.file("none.rvox")));
    EXPECT_FALSE(readVoxelFile(scratch.path().string()));
}

TEST(VoxelFile, EveryTruncationIsAnError) {
    const std::string whole = packed(makeFile(1, ivec3(31, 15, 11), true, true));
    ASSERT_GT(whole.size(), 20000U);
    std::mt19937 random(1);
    for (int k = 0; k < 10000; ++k) {
        const size_t length = k < 1000 ? static_cast<size_t>(k) : random() % whole.size();
        const Result<VoxelFile> read = unpack(whole.substr(0, length));
        ASSERT_FALSE(read) << length;
        ASSERT_TRUE(read.error().message.starts_with("some.rvox: ")) << read.error().message;
    }
    EXPECT_FALSE(unpack(whole + "x"));
    EXPECT_FALSE(unpack(whole + whole));
}

TEST(VoxelFile, EveryFlippedBitIsAnError) {
    const std::string whole = packed(makeFile(2, ivec3(31, 15, 11), true, true));
    std::mt19937 random(2);
    for (int k = 0; k < 10000; ++k) {
        const size_t bit = k < 3000 ? static_cast<size_t>(k) : random() % (whole.size() * 8);
        std::string broken = whole;
        broken[bit / 8] = static_cast<char>(static_cast<uint8_t>(broken[bit / 8]) ^ (1U << (bit % 8)));
        const Result<VoxelFile> read = unpack(broken);
        ASSERT_FALSE(read) << "bit " << bit;
        ASSERT_EQ(read.error().fault, Fault::badInput);
    }
}

// Checks every invariant of the types on a result.
void expectSound(const VoxelFile& f) {
    ASSERT_TRUE(f.bits.count() > 0 && f.bits.voxel > 0 && isFinite(f.bits.origin));
    ASSERT_EQ(f.bits.bits.size(), (f.bits.count() + 31) / 32 * 4);
    if (f.labels) {
        const VoxelLabels& l = *f.labels;
        ASSERT_EQ(l.rowStart.size(), static_cast<size_t>(l.size.y) * static_cast<size_t>(l.size.z) + 1);
        ASSERT_EQ(l.rowStart.back(), l.runs.size());
        for (size_t row = 0; row + 1 < l.rowStart.size(); ++row) {
            ASSERT_LT(l.rowStart[row], l.rowStart[row + 1]);
            ASSERT_EQ(l.runs[l.rowStart[row]].x, 0U);
            for (size_t k = l.rowStart[row]; k < l.rowStart[row + 1]; ++k) {
                ASSERT_LT(l.runs[k].x, static_cast<uint32_t>(l.size.x));
                ASSERT_TRUE(k == l.rowStart[row] || (l.runs[k - 1].x < l.runs[k].x && l.runs[k - 1].label != l.runs[k].label));
                ASSERT_LT(l.runs[k].label, kFirstMaterial + l.materials.size());
            }
        }
        size_t all = l.outside + l.surface;
        for (const VoxelMaterial& m : l.materials) {
            all += m.voxels;
            ASSERT_TRUE(std::isfinite(m.volume) && m.voxels > 0);
        }
        ASSERT_EQ(all, f.bits.count());
    }
    if (f.band)
        for (float d : f.band->distance) ASSERT_TRUE(std::abs(d) <= f.band->band);
}

TEST(VoxelFile, WithRightChecksumsTheResultIsSoundOrAnError) {
    std::mt19937 random(3);
    size_t sound = 0, refused = 0;
    for (unsigned which = 0; which < 4; ++which) {
        const std::string whole = packed(makeFile(which, ivec3(13, 7, 5), (which & 1U) != 0, (which & 2U) != 0));
        const size_t head = kHeaderBytes + kSectionBytes * valueAt<uint32_t>(whole, 20);
        for (int k = 0; k < 4000; ++k) {
            std::string broken = whole;
            for (unsigned flips = 1 + random() % 3; flips > 0; --flips) {
                const size_t bit = random() % (8 * (random() % 2 == 0 ? head : whole.size()));
                broken[bit / 8] = static_cast<char>(static_cast<uint8_t>(broken[bit / 8]) ^ (1U << (bit % 8)));
            }
            seal(broken);
            const Result<VoxelFile> read = unpack(broken, size_t{64} << 20U);
            if (read) ASSERT_NO_FATAL_FAILURE(expectSound(*read));
            ++(read ? sound : refused);
        }
    }
    EXPECT_GT(sound, 500U) << "the test must reach the checks after the checksums";
    EXPECT_GT(refused, 5000U);
}

TEST(VoxelFile, ForgedLabelsAreRefused) {
    const Result<VoxelFile> good = unpack(forgedLabels().bytes());
    ASSERT_TRUE(good) << good.error().message;
    EXPECT_EQ(good->labels->outside, 13U);
    EXPECT_EQ(good->labels->materials[0].voxels, 2U);

    const std::vector<Record> right = {{2, 0.25, {2, 0, 0}, {3, 0, 0}}};
    const std::pair<const char*, Forgery> cases[] = {
        {"a row without runs", forgedLabels({3, 0, 2, 1})},
        {"more runs than there are", forgedLabels({3, 1, 1, 2})},
        {"fewer runs than there are", forgedLabels({2, 1, 1, 1})},
        {"a count that overflows", forgedLabels({3, 1, 1, 0xFFFFFFFFU})},
        {"a row that begins late", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 1, 0, 0})},
        {"x that does not grow", forgedLabels({3, 1, 1, 1}, {0, 2, 2, 0, 0, 0})},
        {"x that shrinks", forgedLabels({3, 1, 1, 1}, {0, 2, 1, 0, 0, 0})},
        {"x beyond the row", forgedLabels({3, 1, 1, 1}, {0, 1, 4, 0, 0, 0})},
        {"x far beyond", forgedLabels({3, 1, 1, 1}, {0, 1, 0x80000002U, 0, 0, 0})},
        {"a label of no material", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 3, 0, 0, 0})},
        {"the largest label", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 0xFFFFFFFFU, 0, 0, 0})},
        {"neighbours alike", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 2, 2, 0, 0, 0})},
        {"a material of no voxel", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 0, 0, 0, 0})},
        {"wrong voxels", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0, 0}, {{3, 0.375, {2, 0, 0}, {3, 0, 0}}})},
        {"wrong volume", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0, 0}, {{2, 0.3, {2, 0, 0}, {3, 0, 0}}})},
        {"NaN", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0, 0}, {{2, std::nan(""), {2, 0, 0}, {3, 0, 0}}})},
        {"wrong bounds", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0, 0}, {{2, 0.25, {2, 0, 0}, {3, 1, 0}}})},
        {"neither solid nor hollow",
         forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0, 0}, {{2, 0.25, {2, 0, 0}, {3, 0, 0}, 2}})},
        {"more materials than runs", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0, 0}, std::vector<Record>(7, right[0]))},
        {"an odd number of words", forgedLabels({3, 1, 1, 1}, {0, 1, 2, 0, 0, 0}, {0, 1, 2, 0, 0})},
        {"no runs", forgedLabels({}, {}, {})},
    };
    for (const auto& [what, forgery] : cases) {
        const Result<VoxelFile> read = unpack(forgery.bytes());
        EXPECT_FALSE(read) << what;
        if (!read) EXPECT_NE(read.error().message.find("section "), std::string::npos) << what << ": " << read.error().message;
    }
}

TEST(VoxelFile, ForgedFramesAndSectionsAreRefused) {
    const auto refused = [](const Forgery& f, const char* mentions) {
        const std::string error = errorOf(unpack(f.bytes()));
        EXPECT_NE(error.find(mentions), std::string::npos) << "'" << mentions << "' is not in: " << error;
        EXPECT_NE(error.find("some.rvox: "), std::string::npos) << error;
    };
    Forgery plain;
    plain.add(1, Bytes{1, 2, 0, 0});
    ASSERT_TRUE(unpack(plain.bytes())) << errorOf(unpack(plain.bytes()));
    for (const ivec3& size : {ivec3(0, 2, 2), ivec3(4, -2, -2), ivec3(4, 2, 70000), ivec3(INT32_MIN, 1, 1)}) {
        Forgery f = plain;
        f.size = size;
        refused(f, "byte 24");
    }
    for (float voxel : {0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::nanf(""), 1e-44F}) {
        Forgery f = plain;
        f.voxel = voxel;
        refused(f, "byte 48");
    }
    for (float band : {-1.0F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
        Forgery f = plain;
        f.band = band;
        refused(f, "byte 52");
    }
    {
        Forgery f = plain;
        f.band = 1;
        refused(f, "distance is missing");
        f.add(4, std::vector<float>(45, 0.5F));
        refused(f, "normal is missing");
        f.add(5, Words(45, 0));
        EXPECT_TRUE(unpack(f.bytes())) << errorOf(unpack(f.bytes()));
        f.band = 0;
        refused(f, "distance is not expected");
        f.band = 0.25F;
        refused(f, "outside the band");
    }
    for (float stray : {1.5F, -1.5F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
        Forgery f = plain;
        f.band = 1;
        std::vector<float> distance(45, 0.5F);
        distance[44] = stray;
        f.add(4, distance);
        f.add(5, Words(45, 0));
        refused(f, "distance 44");
    }
    {
        Forgery f = plain;
        f.add(1, Bytes{1, 2, 0, 0});
        refused(f, "section of kind 1");
        f.parts.pop_back();
        f.add(9, Bytes{1});
        refused(f, "section of kind 9");
    }
    {
        Forgery f;
        f.add(1, Bytes{1, 2, 1, 0});
        refused(f, "after the last voxel");
    }
    {
        Forgery f;
        f.add(1, Bytes{1, 2, 0, 0, 0});
        refused(f, "5 bytes");
        f.parts[0].bytes = 4;
        refused(f, "extra bytes at its end");
        Forgery shorter;
        shorter.add(1, Bytes{1, 2, 0});
        shorter.parts[0].bytes = 4;
        refused(shorter, "ends too early");
        shorter.parts[0].packed = "no frame";
        refused(shorter, "cannot be unpacked");
        shorter = plain;
        shorter.parts[0].packed += plain.parts[0].packed;
        refused(shorter, "extra bytes at its end");
    }
    {
        Forgery f = plain;
        f.add(2, Words{1, 1, 1, 1}, Words(4, 0), Words(4, 0));
        refused(f, "labels and materials must both be present");
    }
    for (const size_t bytes : {size_t{0}, size_t{1025}, size_t{100000}}) {
        Forgery f = plain;
        f.add(6, std::vector<char>(bytes, 'k'));
        refused(f, "section key");
    }
    EXPECT_NE(errorOf(unpack("")).find("empty"), std::string::npos);
    EXPECT_NE(errorOf(unpack("# a scene\n")).find("not the beginning of a voxel file"), std::string::npos);
    std::string other = plain.bytes();
    setAt(other, 8, 0x04030201U);
    EXPECT_NE(errorOf(unpack(other)).find("other byte order"), std::string::npos);
    other = plain.bytes();
    setAt(other, 12, 2U);
    EXPECT_NE(errorOf(unpack(other)).find("version is 2"), std::string::npos);
}

long peakKiB() {
    struct rusage usage {};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

// Memory for claimed sizes is not allocated before the bytes are read.
TEST(VoxelFile, LargeClaimsTakeNoMemory) {
    const auto claim = [](int side, std::string body, size_t limit) {
        Forgery f;
        f.size = ivec3(side);
        f.parts.push_back(
            {1, static_cast<uint64_t>(side) * static_cast<uint64_t>(side) * static_cast<uint64_t>(side) / 8, std::move(body)});
        return unpack(f.bytes(), limit);
    };
    constexpr size_t kAll = SIZE_MAX;
    std::string small, large;
    {
        ArrayPacker packer(small);
        packer.put(std::span<const uint8_t>(Bytes(1000, 0)));
        packer.finish();
        ArrayPacker filler(large);
        std::mt19937 random(5);
        Bytes noise(1000000);
        for (uint8_t& byte : noise) byte = static_cast<uint8_t>(random());
        filler.put(std::span<const uint8_t>(noise));
        filler.finish();
    }
    const long before = peakKiB();
    EXPECT_NE(errorOf(claim(4096, small, kAll)).find("cannot be packed into"), std::string::npos);
    EXPECT_NE(errorOf(claim(4096, large, kAll)).find("ends too early"), std::string::npos);
    EXPECT_NE(errorOf(claim(4096, large, size_t{4} << 30U)).find("8.6 GB"), std::string::npos);
    EXPECT_NE(errorOf(claim(1024, large, kAll)).find("ends too early"), std::string::npos);
    EXPECT_NE(errorOf(claim(1024, std::string(10000, 'x'), kAll)).find("cannot be unpacked"), std::string::npos);
    EXPECT_LT(peakKiB() - before, 64 << 10);
}

}  // namespace
}  // namespace rivulet::voxel_file_test
