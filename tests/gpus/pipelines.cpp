// gpu_pipelines: reads lines "NAME a.comp.spv" or "NAME a.vert.spv a.frag.spv" and prints what the driver's compiler reports of each stage
// (VK_KHR_pipeline_executable_properties), separated by tabs: NAME, stage, threads of a wave, then "STATISTIC=value" for each.
// run.sh starts it with RADV's null device (RADV_FORCE_FAMILY), which compiles for a GPU that is not there and runs nothing.
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

// The parts of SPIR-V's instruction set that are read here (Khronos, SPIR-V specification 1.0, section 3).
enum : uint32_t {
    kName = 5,
    kTypeFloat = 22,
    kTypeVector = 23,
    kTypeImage = 25,
    kTypeSampledImage = 27,
    kTypeArray = 28,
    kTypePointer = 32
};
enum : uint32_t { kConstant = 43, kVariable = 59, kDecorate = 71, kTypeInt = 21 };
enum : uint32_t { kBufferBlock = 3, kBuiltIn = 11, kLocation = 30, kBinding = 33, kDescriptorSet = 34 };
enum : uint32_t { kUniformConstant = 0, kInput = 1, kUniform = 2, kOutput = 3, kStorageBuffer = 12, kDimBuffer = 5 };

struct Instruction {
    uint32_t op = 0;
    size_t at = 0;  // of its first word
    size_t words = 0;
};

// Gives the descriptors of a module new numbers: OpenGL counts each kind of binding separately, Vulkan counts all together.
struct Module {
    std::vector<uint32_t> code;
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    std::vector<VkVertexInputAttributeDescription> inputs;  // of a vertex shader
    std::map<std::string, size_t> locations[2];             // of inputs and outputs, by name: the word that holds each
    uint32_t outputs = 0;                                   // render targets

    Module(const std::string& path, VkShaderStageFlagBits stage, uint32_t set);

  private:
    VkDescriptorType typeOf(uint32_t variable) const;
    VkFormat formatOf(uint32_t type) const;
    std::map<uint32_t, Instruction> made_;                        // types, constants and variables, by id
    std::map<uint32_t, std::map<uint32_t, size_t>> decorations_;  // by id and decoration: the word that holds its value
};

Module::Module(const std::string& path, VkShaderStageFlagBits stage, uint32_t set) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    code.resize(bytes.size() / 4);
    std::copy(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(4 * code.size()), reinterpret_cast<char*>(code.data()));
    std::map<uint32_t, std::string> names;
    std::vector<uint32_t> variables;
    for (size_t at = 5; at < code.size();) {
        const Instruction i{code[at] & 0xFFFFU, at, code[at] >> 16U};
        if (i.words == 0) break;
        if (i.op == kName) names[code[at + 1]] = reinterpret_cast<const char*>(&code[at + 2]);
        if (i.op == kDecorate) decorations_[code[at + 1]][code[at + 2]] = i.words > 3 ? at + 3 : 0;
        if (i.op >= kTypeInt && i.op <= kTypePointer) made_[code[at + 1]] = i;
        if (i.op == kConstant || i.op == kVariable) made_[code[at + 2]] = i;
        if (i.op == kVariable) variables.push_back(code[at + 2]);
        at += i.words;
    }
    for (const uint32_t variable : variables) {
        const size_t at = made_.at(variable).at;
        const uint32_t storage = code[at + 3];
        std::map<uint32_t, size_t>& decorations = decorations_[variable];
        if (decorations.contains(kBinding)) {
            uint32_t type = code[made_.at(code[at + 1]).at + 3], count = 1;
            if (made_.at(type).op == kTypeArray) count = code[made_.at(code[made_.at(type).at + 3]).at + 3];
            const auto number = static_cast<uint32_t>(bindings.size());
            bindings.push_back({number, typeOf(variable), count, static_cast<VkShaderStageFlags>(stage), nullptr});
            code[decorations.at(kBinding)] = number;
            code[decorations.at(kDescriptorSet)] = set;
        } else if ((storage == kInput || storage == kOutput) && decorations.contains(kLocation)) {
            const size_t word = decorations.at(kLocation);
            locations[storage == kOutput ? 1 : 0][names[variable]] = word;
            const uint32_t type = code[made_.at(code[at + 1]).at + 3];
            if (storage == kInput) inputs.push_back({code[word], 0, formatOf(type), 0});
            if (storage == kOutput) outputs = std::max(outputs, code[word] + 1);
        }
    }
}

VkDescriptorType Module::typeOf(uint32_t variable) const {
    const Instruction& v = made_.at(variable);
    uint32_t type = code[made_.at(code[v.at + 1]).at + 3];
    if (made_.contains(type) && made_.at(type).op == kTypeArray) type = code[made_.at(type).at + 2];
    if (code[v.at + 3] == kStorageBuffer) return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    if (code[v.at + 3] == kUniform) {
        const auto decorations = decorations_.find(type);
        const bool storage = decorations != decorations_.end() && decorations->second.contains(kBufferBlock);
        return storage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    }
    const bool sampled = made_.at(type).op == kTypeSampledImage;
    const Instruction& image = made_.at(sampled ? code[made_.at(type).at + 2] : type);
    if (code[image.at + 3] == kDimBuffer)
        return sampled ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    return sampled ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}

VkFormat Module::formatOf(uint32_t type) const {
    uint32_t count = 1;
    if (made_.at(type).op == kTypeVector) {
        count = code[made_.at(type).at + 3];
        type = code[made_.at(type).at + 2];
    }
    constexpr VkFormat kFloats[] = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT,
                                    VK_FORMAT_R32G32B32A32_SFLOAT};
    constexpr VkFormat kInts[] = {VK_FORMAT_R32_UINT, VK_FORMAT_R32G32_UINT, VK_FORMAT_R32G32B32_UINT, VK_FORMAT_R32G32B32A32_UINT};
    return made_.at(type).op == kTypeFloat ? kFloats[count - 1] : kInts[count - 1];
}

class Compiler {
  public:
    bool open();
    bool print(const std::string& name, const std::vector<std::string>& files);

  private:
    VkPipeline compute(const VkPipelineShaderStageCreateInfo& stage, VkPipelineLayout layout);
    VkPipeline graphics(const std::vector<VkPipelineShaderStageCreateInfo>& stages, VkPipelineLayout layout, const Module& vertex,
                        uint32_t targets);
    void printStages(const std::string& name, VkPipeline pipeline);

    VkDevice device_ = nullptr;
    PFN_vkGetPipelineExecutablePropertiesKHR properties_ = nullptr;
    PFN_vkGetPipelineExecutableStatisticsKHR statistics_ = nullptr;
};

bool Compiler::open() {
    VkApplicationInfo app{};
    app.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    app.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo instanceInfo{};
    instanceInfo.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    instanceInfo.pApplicationInfo = &app;
    VkInstance instance = nullptr;
    if (vkCreateInstance(&instanceInfo, nullptr, &instance) != VK_SUCCESS) return false;
    uint32_t count = 1;
    VkPhysicalDevice gpu = nullptr;
    if (vkEnumeratePhysicalDevices(instance, &count, &gpu) < 0 || count == 0) return false;
    VkPhysicalDeviceProperties about;
    vkGetPhysicalDeviceProperties(gpu, &about);
    std::cout << "# " << about.deviceName << "\n";
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables{};
    executables.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR;
    VkPhysicalDeviceVulkan13Features newer{};
    newer.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    newer.pNext = &executables;
    VkPhysicalDeviceFeatures2 features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    features.pNext = &newer;
    vkGetPhysicalDeviceFeatures2(gpu, &features);
    features.features.robustBufferAccess = VK_FALSE;  // OpenGL does not have it either
    newer.robustImageAccess = VK_FALSE;
    if (executables.pipelineExecutableInfo == VK_FALSE || newer.dynamicRendering == VK_FALSE) return false;
    const float priority = 1;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    const char* extension = "VK_KHR_pipeline_executable_properties";
    VkDeviceCreateInfo deviceInfo{};
    deviceInfo.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    deviceInfo.pNext = &features;
    deviceInfo.queueCreateInfoCount = 1;
    deviceInfo.pQueueCreateInfos = &queue;
    deviceInfo.enabledExtensionCount = 1;
    deviceInfo.ppEnabledExtensionNames = &extension;
    if (vkCreateDevice(gpu, &deviceInfo, nullptr, &device_) != VK_SUCCESS) return false;
    const auto entry = [&](const char* function) { return vkGetDeviceProcAddr(device_, function); };
    properties_ = reinterpret_cast<PFN_vkGetPipelineExecutablePropertiesKHR>(entry("vkGetPipelineExecutablePropertiesKHR"));
    statistics_ = reinterpret_cast<PFN_vkGetPipelineExecutableStatisticsKHR>(entry("vkGetPipelineExecutableStatisticsKHR"));
    return properties_ != nullptr && statistics_ != nullptr;
}

VkPipeline Compiler::compute(const VkPipelineShaderStageCreateInfo& stage, VkPipelineLayout layout) {
    VkComputePipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.flags = VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    info.stage = stage;
    info.layout = layout;
    VkPipeline pipeline = nullptr;
    return vkCreateComputePipelines(device_, nullptr, 1, &info, nullptr, &pipeline) == VK_SUCCESS ? pipeline : nullptr;
}

// Triangles into targets of 16-bit floats and a depth of 32 bits, as most passes draw.
VkPipeline Compiler::graphics(const std::vector<VkPipelineShaderStageCreateInfo>& stages, VkPipelineLayout layout, const Module& vertex,
                              uint32_t targets) {
    const VkVertexInputBindingDescription rows{0, 64, VK_VERTEX_INPUT_RATE_VERTEX};
    VkPipelineVertexInputStateCreateInfo input{};
    input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    input.vertexBindingDescriptionCount = vertex.inputs.empty() ? 0 : 1;
    input.pVertexBindingDescriptions = &rows;
    input.vertexAttributeDescriptionCount = static_cast<uint32_t>(vertex.inputs.size());
    input.pVertexAttributeDescriptions = vertex.inputs.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    const VkViewport viewport{0, 0, 1280, 720, 0, 1};
    const VkRect2D scissor{{0, 0}, {1280, 720}};
    VkPipelineViewportStateCreateInfo view{};
    view.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    view.viewportCount = view.scissorCount = 1;
    view.pViewports = &viewport;
    view.pScissors = &scissor;
    VkPipelineRasterizationStateCreateInfo raster{};
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{};
    samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{};
    depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    VkPipelineColorBlendAttachmentState written{};
    written.colorWriteMask = 15;
    const std::vector<VkPipelineColorBlendAttachmentState> blends(targets, written);
    VkPipelineColorBlendStateCreateInfo blend{};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = targets;
    blend.pAttachments = blends.data();
    const std::vector<VkFormat> formats(targets, VK_FORMAT_R16G16B16A16_SFLOAT);
    VkPipelineRenderingCreateInfo rendering{};
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = targets;
    rendering.pColorAttachmentFormats = formats.data();
    rendering.depthAttachmentFormat = VK_FORMAT_D32_SFLOAT;
    VkGraphicsPipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    info.pNext = &rendering;
    info.flags = VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    info.stageCount = static_cast<uint32_t>(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &view;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.layout = layout;
    VkPipeline pipeline = nullptr;
    return vkCreateGraphicsPipelines(device_, nullptr, 1, &info, nullptr, &pipeline) == VK_SUCCESS ? pipeline : nullptr;
}

void Compiler::printStages(const std::string& name, VkPipeline pipeline) {
    VkPipelineInfoKHR which{};
    which.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR;
    which.pipeline = pipeline;
    uint32_t count = 0;
    properties_(device_, &which, &count, nullptr);
    VkPipelineExecutablePropertiesKHR noProperties{};
    noProperties.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR;
    std::vector<VkPipelineExecutablePropertiesKHR> stages(count, noProperties);
    properties_(device_, &which, &count, stages.data());
    for (uint32_t k = 0; k < count; ++k) {
        const VkShaderStageFlags stage = stages[k].stages;
        std::cout << name << '\t'
                  << (stage & VK_SHADER_STAGE_COMPUTE_BIT    ? "compute"
                      : stage & VK_SHADER_STAGE_FRAGMENT_BIT ? "fragment"
                                                             : "vertex")
                  << '\t' << stages[k].subgroupSize;
        VkPipelineExecutableInfoKHR executable{};
        executable.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR;
        executable.pipeline = pipeline;
        executable.executableIndex = k;
        uint32_t figures = 0;
        statistics_(device_, &executable, &figures, nullptr);
        VkPipelineExecutableStatisticKHR noStatistic{};
        noStatistic.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR;
        std::vector<VkPipelineExecutableStatisticKHR> found(figures, noStatistic);
        statistics_(device_, &executable, &figures, found.data());
        for (const VkPipelineExecutableStatisticKHR& s : found)
            if (s.format == VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR) std::cout << '\t' << s.name << '=' << s.value.u64;
        std::cout << '\n';
    }
}

bool Compiler::print(const std::string& name, const std::vector<std::string>& files) {
    const bool draws = files.size() == 2;
    const VkShaderStageFlagBits kinds[] = {draws ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_COMPUTE_BIT, VK_SHADER_STAGE_FRAGMENT_BIT};
    std::vector<Module> modules;
    modules.reserve(files.size());
    for (size_t k = 0; k < files.size(); ++k) modules.emplace_back(files[k], kinds[k], static_cast<uint32_t>(k));
    if (draws)  // OpenGL links by name, Vulkan by number
        for (const auto& [varying, word] : modules[1].locations[0])
            if (const auto from = modules[0].locations[1].find(varying); from != modules[0].locations[1].end())
                modules[1].code[word] = modules[0].code[from->second];
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    std::vector<VkDescriptorSetLayout> sets;
    stages.reserve(modules.size());
    sets.reserve(modules.size());
    for (size_t k = 0; k < modules.size(); ++k) {
        VkShaderModuleCreateInfo moduleInfo{};
        moduleInfo.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        moduleInfo.codeSize = 4 * modules[k].code.size();
        moduleInfo.pCode = modules[k].code.data();
        VkPipelineShaderStageCreateInfo stage{};
        stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        stage.stage = kinds[k];
        stage.pName = "main";
        if (vkCreateShaderModule(device_, &moduleInfo, nullptr, &stage.module) != VK_SUCCESS) return false;
        stages.push_back(stage);
        VkDescriptorSetLayoutCreateInfo setInfo{};
        setInfo.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
        setInfo.bindingCount = static_cast<uint32_t>(modules[k].bindings.size());
        setInfo.pBindings = modules[k].bindings.data();
        if (vkCreateDescriptorSetLayout(device_, &setInfo, nullptr, &sets.emplace_back()) != VK_SUCCESS) return false;
    }
    VkPipelineLayoutCreateInfo layoutInfo{};
    layoutInfo.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    layoutInfo.setLayoutCount = static_cast<uint32_t>(sets.size());
    layoutInfo.pSetLayouts = sets.data();
    VkPipelineLayout layout = nullptr;
    if (vkCreatePipelineLayout(device_, &layoutInfo, nullptr, &layout) != VK_SUCCESS) return false;
    VkPipeline pipeline = draws ? graphics(stages, layout, modules[0], modules[1].outputs) : compute(stages[0], layout);
    if (pipeline == nullptr) return false;
    printStages(name, pipeline);
    vkDestroyPipeline(device_, pipeline, nullptr);
    return true;
}

}  // namespace

int main() {
    Compiler compiler;
    if (!compiler.open()) {
        std::cerr << "the driver has no Vulkan 1.3 device that reports what it compiles\n";
        return 1;
    }
    int failures = 0;
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string name;
        words >> name;
        const std::vector<std::string> files(std::istream_iterator<std::string>(words), {});
        if (files.empty() || files.size() > 2 || compiler.print(name, files)) continue;
        std::cerr << "the driver does not compile " << line << "\n";
        ++failures;
    }
    return failures > 0 ? 1 : 0;
}
