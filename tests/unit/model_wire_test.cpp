// A model on its way from the reader's process: it arrives exactly, and any other bytes are an error or a sound model.
#include "engine/scene/model_wire.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "engine/scene/model_check.h"
#include "tests/unit/whole_model.h"

namespace rivulet::model_wire_test {
namespace {

using whole_model::everything;

std::vector<std::byte> sent(const Model& model) {
    std::vector<std::byte> bytes;
    EXPECT_TRUE(sendModel(model, [&bytes](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    }));
    return bytes;
}

std::vector<std::byte> sentFault(const std::string& phrase) {
    std::vector<std::byte> bytes;
    EXPECT_TRUE(sendFault(phrase, [&bytes](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    }));
    return bytes;
}

TEST(ModelWire, AModelArrivesBitForBit) {
    const Model model = everything();
    ASSERT_EQ(faultOf(model), "");
    const std::vector<std::byte> bytes = sent(model);
    const Result<Model> read = receiveModel(bytes);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_TRUE(sent(*read) == bytes) << "what arrived is sent as the same bytes";
    ASSERT_EQ(read->parts.size(), 2U);
    const ModelPart& part = read->parts[0];
    EXPECT_EQ(part.mesh.positions, model.parts[0].mesh.positions);
    EXPECT_EQ(part.mesh.indices, model.parts[0].mesh.indices);
    EXPECT_EQ(part.material.colour->rgba, model.parts[0].material.colour->rgba);
    EXPECT_EQ(part.material.colour->name, "picture");
    EXPECT_EQ(part.material.colour, part.material.normals) << "one image, used twice";
    EXPECT_EQ(part.material.colour, read->parts[1].material.colour);
    EXPECT_EQ(read->parts[1].material.glow->width, 2);
    EXPECT_EQ(read->nodes[2].parent, 1);
    EXPECT_EQ(read->clips.at(0).morphs.at(0).weights.values.at(1), (std::vector<float>{1, 0.5F}));
    EXPECT_EQ(read->cameras.at(0).fieldOfView, 30);
    EXPECT_EQ(read->lights.at(0).colour, vec3(5, 5, 4));
    EXPECT_EQ(part.morphs.at(0).vertices, (std::vector<uint32_t>{1, 3}));
}

TEST(ModelWire, LargeArraysToo) {
    Model model = everything();
    Mesh& mesh = model.parts[0].mesh;
    mesh.uvs.clear();
    model.parts[0].morphs.clear();
    model.parts[0].restWeights.clear();
    model.parts[0].grips.clear();
    mesh.positions.assign(100'000, vec3(0.5F));
    mesh.normals.assign(100'000, vec3(1, 0, 0));
    for (uint32_t k = 0; k < 299'997; ++k) mesh.indices.push_back(k % 100'000);
    const Result<Model> read = receiveModel(sent(model));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->parts[0].mesh.indices, mesh.indices);
    EXPECT_EQ(read->parts[0].mesh.positions, mesh.positions);
}

TEST(ModelWire, AFaultArrivesAsOneReadableLine) {
    EXPECT_EQ(receiveModel(sentFault("has no triangles")).error().message, "has no triangles");
    EXPECT_EQ(receiveModel(sentFault("has \x1B[31m red\r\n \xC2\x9B name\x7F")).error().message, "has ?[31m red?? \xC2? name?");
    EXPECT_LE(receiveModel(sentFault(std::string(5000, 'a'))).error().message.size(), 410U);
    EXPECT_FALSE(receiveModel(sentFault("")).error().message.empty());
}

TEST(ModelWire, ControlCharactersOfNamesDoNotArrive) {
    Model model = everything();
    model.parts[0].name = "skin\x1B]0;title\x07";
    model.nodes[0].name = std::string("a\0b\n", 4);
    const Result<Model> read = receiveModel(sent(model));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->parts[0].name, "skin?]0;title?");
    EXPECT_EQ(read->nodes[0].name, "a?b?");
}

// Whatever arrives is an error, or a model without a fault; the run with sanitizers sees every byte that is read.
TEST(ModelWire, CutBytesAreAnError) {
    const std::vector<std::byte> whole = sent(everything());
    for (size_t length = 0; length < whole.size(); ++length) {
        const Result<Model> read = receiveModel(std::span(whole).first(length));
        ASSERT_FALSE(read) << length;
        ASSERT_EQ(read.error().fault, Fault::badInput);
    }
    std::vector<std::byte> longer(whole.size() + 1);  // the last is 0
    std::copy(whole.begin(), whole.end(), longer.begin());
    EXPECT_FALSE(receiveModel(longer));
}

TEST(ModelWire, ChangedBytesAreAnErrorOrASoundModel) {
    const std::vector<std::byte> whole = sent(everything());
    std::mt19937 random(29);
    size_t sound = 0, refused = 0;
    const auto expectSound = [&](std::span<const std::byte> bytes) {
        const Result<Model> read = receiveModel(bytes);
        ++(read ? sound : refused);
        if (read) ASSERT_EQ(faultOf(*read), "");
        if (!read) ASSERT_FALSE(read.error().message.empty());
    };
    for (size_t at = 0; at < whole.size(); ++at) {
        for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
            std::vector<std::byte> broken = whole;
            broken[at] = static_cast<std::byte>(value);
            ASSERT_NO_FATAL_FAILURE(expectSound(broken)) << "byte " << at;
        }
    }
    for (int k = 0; k < 20'000; ++k) {
        std::vector<std::byte> broken = whole;
        for (unsigned times = 1 + random() % 4; times > 0; --times) {
            const size_t at = random() % broken.size();
            switch (random() % 4) {
                case 0:  // another bit
                    broken[at] ^= static_cast<std::byte>(1U << (random() % 8));
                    break;
                case 1:  // a word that is a length, an index or a number out of range
                    for (size_t b = 0; b < 4 && at + b < broken.size(); ++b) broken[at + b] = std::byte{0xFF};
                    break;
                case 2:  // bytes from elsewhere
                    for (size_t b = 0; b < 8 && at + b < broken.size(); ++b) broken[at + b] = whole[random() % whole.size()];
                    break;
                default:  // cut out
                    broken.erase(broken.begin() + static_cast<std::ptrdiff_t>(at),
                                 broken.begin() + static_cast<std::ptrdiff_t>(std::min(broken.size(), at + 1 + random() % 16)));
                    if (broken.empty()) broken = whole;
            }
        }
        ASSERT_NO_FATAL_FAILURE(expectSound(broken)) << k;
    }
    EXPECT_GT(sound, 1000U) << "numbers that are another sound value";
    EXPECT_GT(refused, 5000U);
}

// Each invariant by itself: an index, a count or a number that a hostile writer would choose.
TEST(ModelWire, EveryInvariantIsChecked) {
    const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
    const std::vector<std::pair<const char*, std::function<void(Model&)>>> cases = {
        {"a parent after its child", [](Model& m) { m.nodes[1].parent = 1; }},
        {"a parent of no node", [](Model& m) { m.nodes[1].parent = -2; }},
        {"a matrix", [&](Model& m) { m.nodes[0].local[3][1] = nan; }},
        {"no parts", [](Model& m) { m.parts.clear(); }},
        {"a part of no node", [](Model& m) { m.parts[0].node = 3; }},
        {"a part of a negative node", [](Model& m) { m.parts[0].node = -1; }},
        {"a position", [&](Model& m) { m.parts[0].mesh.positions[2].y = infinite; }},
        {"a far position", [](Model& m) { m.parts[0].mesh.positions[2].y = 2e15F; }},
        {"a normal", [&](Model& m) { m.parts[0].mesh.normals[2].x = nan; }},
        {"few normals", [](Model& m) { m.parts[0].mesh.normals.pop_back(); }},
        {"a uv", [&](Model& m) { m.parts[0].mesh.uvs[0].x = nan; }},
        {"few uvs", [](Model& m) { m.parts[0].mesh.uvs.pop_back(); }},
        {"no triangle", [](Model& m) { m.parts[0].mesh.indices.clear(); }},
        {"half a triangle", [](Model& m) { m.parts[0].mesh.indices.pop_back(); }},
        {"an index", [](Model& m) { m.parts[0].mesh.indices[4] = 4; }},
        {"a colour", [&](Model& m) { m.parts[0].material.baseColour.x = nan; }},
        {"an emission", [&](Model& m) { m.parts[0].material.emission.x = infinite; }},
        {"an opacity", [&](Model& m) { m.parts[0].material.opacity = nan; }},
        {"an image of no texels", [](Model& m) { m.parts[0].material.colour = std::make_shared<Image>(); }},
        {"an image that is too short",
         [](Model& m) {
             auto image = std::make_shared<Image>(*m.parts[0].material.colour);
             image->rgba.pop_back();
             m.parts[0].material.glow = image;
         }},
        {"a size that overflows",
         [](Model& m) {
             auto image = std::make_shared<Image>(*m.parts[0].material.colour);
             image->width = image->height = 65536;
             m.parts[0].material.glow = image;
         }},
        {"a morph's vertex", [](Model& m) { m.parts[0].morphs[0].vertices[1] = 4; }},
        {"a morph's order",
         [](Model& m) {
             m.parts[0].morphs[0].vertices = {3, 1};
         }},
        {"a morph's offsets", [](Model& m) { m.parts[0].morphs[0].offsets.pop_back(); }},
        {"a morph's offset", [&](Model& m) { m.parts[0].morphs[0].offsets[0].x = nan; }},
        {"few rest weights", [](Model& m) { m.parts[0].restWeights.pop_back(); }},
        {"a rest weight", [&](Model& m) { m.parts[0].restWeights[0] = nan; }},
        {"a bone's node", [](Model& m) { m.parts[0].bones[1].node = 7; }},
        {"a bone's matrix", [&](Model& m) { m.parts[0].bones[1].fromMesh[0][0] = nan; }},
        {"few grips", [](Model& m) { m.parts[0].grips.pop_back(); }},
        {"a grip's bone", [](Model& m) { m.parts[0].grips[1].bone.w = 2; }},
        {"a grip's weight", [&](Model& m) { m.parts[0].grips[1].weight.w = nan; }},
        {"bones that are missing", [](Model& m) { m.parts[0].bones.clear(); }},
        {"a clip's length", [&](Model& m) { m.clips[0].seconds = std::nan(""); }},
        {"a negative length", [&](Model& m) { m.clips[0].seconds = -1; }},
        {"a track's node", [](Model& m) { m.clips[0].nodes[0].node = 3; }},
        {"times that do not ascend", [](Model& m) { m.clips[0].nodes[0].position.times[1] = 0; }},
        {"a time", [](Model& m) { m.clips[0].nodes[0].position.times[1] = std::nan(""); }},
        {"few values", [](Model& m) { m.clips[0].nodes[0].position.values.pop_back(); }},
        {"a value", [&](Model& m) { m.clips[0].nodes[0].position.values[0].x = nan; }},
        {"a rotation of length 0", [](Model& m) { m.clips[0].nodes[0].rotation.values[0] = glm::quat(0, 0, 0, 0); }},
        {"a morph track's node", [](Model& m) { m.clips[0].morphs[0].node = -1; }},
        {"a key without weights", [](Model& m) { m.clips[0].morphs[0].weights.values[0].clear(); }},
        {"a key's weight", [&](Model& m) { m.clips[0].morphs[0].weights.values[0][0] = nan; }},
        {"a camera's node", [](Model& m) { m.cameras[0].node = 3; }},
        {"a camera's direction", [](Model& m) { m.cameras[0].direction = vec3(0); }},
        {"a camera's angle", [&](Model& m) { m.cameras[0].fieldOfView = nan; }},
        {"a light's node", [](Model& m) { m.lights[0].node = 3; }},
        {"a light's colour", [&](Model& m) { m.lights[0].colour.x = infinite; }},
    };
    for (const auto& [what, change] : cases) {
        Model model = everything();
        change(model);
        EXPECT_NE(faultOf(model), "") << what;
        const Result<Model> read = receiveModel(sent(model));
        EXPECT_FALSE(read) << what;
        if (!read) EXPECT_EQ(read.error().message, faultOf(model)) << what;
    }
}

// A count is no reason to allocate: memory follows the bytes that are there.
TEST(ModelWire, ClaimedCountsTakeNoMemory) {
    const std::vector<std::byte> whole = sent(everything());
    for (const uint64_t claim : {uint64_t{1} << 32U, uint64_t{1} << 61U, UINT64_MAX}) {
        for (size_t at = 8; at + 8 <= whole.size(); ++at) {
            std::vector<std::byte> broken = whole;
            std::memcpy(broken.data() + at, &claim, sizeof claim);
            const Result<Model> read = receiveModel(broken);  // std::bad_alloc would fail the test
            if (read) ASSERT_EQ(faultOf(*read), "");
        }
    }
}

}  // namespace
}  // namespace rivulet::model_wire_test
