/* Tears on a skin that the host deforms on the GPU, drawn with the host's own shader, through rivulet.h.
 * embed_skin [--frames N] [--headless] [--out FILE.ppm] [--backend cpu|gl] [--dry]: stops after N frames and writes the last one;
 * --headless opens no window and needs --frames; --dry adds no drops. */
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <rivulet/rivulet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLSL(...) "#version 450\n" #__VA_ARGS__
enum { WIDTH = 640, HEIGHT = 640, SIDE = 97, VERTICES = SIDE * SIDE, INDICES = 6 * (SIDE - 1) * (SIDE - 1), MAP = 512 };

/* The host's deformation: a cheek that leans back straightens up, sways and breathes. */
static const char* const deform_source = GLSL(
    layout(local_size_x = 64) in;
    layout(binding = 0, std430) readonly buffer Rest { vec4 rest[]; };
    layout(binding = 1, std430) writeonly buffer Moved { vec4 moved[]; };
    uniform float seconds;
    void main() {
        uint i = gl_GlobalInvocationID.x;
        if (i >= uint(rest.length())) return;
        float lean = 1.1 * (1.0 - smoothstep(0.2, 1.0, seconds)), c = cos(lean), s = sin(lean);
        vec3 p = rest[i].xyz;
        p.z *= 1.0 + 0.08 * sin(4.0 * seconds);
        p.x += 0.012 * sin(2.0 * seconds);
        moved[i] = vec4(p.x, c * p.y + s * p.z, c * p.z - s * p.y, 1.0);
    });
static const char* const vertex_source = GLSL(
    layout(location = 0) in vec2 uv;
    layout(location = 1) in vec3 moved;
    uniform mat4 clip_from_world;
    out vec3 place;
    out vec2 at;
    void main() {
        place = moved;
        at = uv;
        gl_Position = clip_from_world * vec4(place, 1.0);
    });
/* The host's material, as docs/embedding.md shows it. */
static const char* const tears_source = GLSL(
    layout(binding = 0) uniform sampler2D tears;  // of rivulet_skin_texture: x, y slope (m a unit of u, of v), z height (mm), w wetness
    uniform vec3 eye;
    uniform vec3 to_light;
    in vec3 place;
    in vec2 at;
    out vec4 colour;

    vec3 skin_at(vec2 uv) { return vec3(0.80, 0.55, 0.45) * (0.96 + 0.08 * step(0.5, fract(16.0 * uv.x)) * step(0.5, fract(16.0 * uv.y))); }
    // GGX with Schlick's Fresnel term; `f0`: reflectance at normal incidence.
    float shine(vec3 n, vec3 to_eye, float roughness, float f0) {
        vec3 h = normalize(to_eye + to_light);
        float a = roughness * roughness, nh = max(dot(n, h), 0.0), d = nh * nh * (a * a - 1.0) + 1.0;
        float fresnel = f0 + (1.0 - f0) * pow(1.0 - max(dot(h, to_eye), 0.0), 5.0);
        return max(dot(n, to_light), 0.0) * fresnel * a * a / (12.566 * d * d * max(0.1, dot(h, to_light) * dot(h, to_light)));
    }
    void main() {
        // The gradients of u and v along the skin, 1/m, from how place and uv change from pixel to pixel.
        vec3 px = dFdx(place), py = dFdy(place), across = cross(px, py);
        vec3 normal = normalize(across), to_eye = normalize(eye - place);
        vec2 ux = dFdx(at), uy = dFdy(at);
        vec3 du = (ux.x * cross(py, normal) + uy.x * cross(normal, px)) / length(across);
        vec3 dv = (ux.y * cross(py, normal) + uy.y * cross(normal, px)) / length(across);

        vec4 map = texture(tears, at);
        vec3 slope = map.x * du + map.y * dv;  // m a m, in the tangent plane
        vec3 n = normalize(normal - slope);
        float wet = clamp(map.w, 0.0, 1.0), drop = smoothstep(0.02, 0.12, map.z);
        // The skin is seen where the refracted ray meets it, below 1e-3 map.z metres of water (index 1.34).
        vec3 ray = refract(-to_eye, n, 1.0 / 1.34);
        vec3 aside = (ray - normal * dot(ray, normal)) * 1.0e-3 * map.z / max(-dot(ray, normal), 0.25);
        vec3 skin = skin_at(at + vec2(dot(du, aside), dot(dv, aside)));
        // Water fills the pores: less light comes back, and the surface is smooth. A drop focuses light on its side away from the lamp.
        skin *= mix(1.0, 0.72, wet) * clamp(1.0 + 2.5 * drop * dot(slope, to_light), 0.4, 2.5);
        float roughness = mix(mix(0.55, 0.22, wet), 0.12, drop);
        vec3 light = skin * (0.25 + 0.55 * max(dot(normal, to_light), 0.0)) + 3.0 * shine(n, to_eye, roughness, mix(0.028, 0.021, wet));
        colour = vec4(pow(light, vec3(1.0 / 2.2)), 1.0);
    });

static rivulet_error why;
static void expect(int fine, const char* what) { if (!fine) exit(fprintf(stderr, "embed_skin: %s\n", what) > 0); }
static void done(rivulet_status status) { expect(status == RIVULET_OK, why.message); }
static void hear(void* user, rivulet_level level, const char* sentence) {
    (void)user;
    if (level >= RIVULET_WARNING) fprintf(stderr, "%s\n", sentence);
}
static GLuint program_of(int count, const GLenum* kinds, const char* const* sources) {
    const GLuint program = glCreateProgram();
    for (int k = 0; k < count; ++k) {
        const GLuint shader = glCreateShader(kinds[k]);
        glShaderSource(shader, 1, &sources[k], NULL);
        glCompileShader(shader);
        glAttachShader(program, shader), glDeleteShader(shader);
    }
    glLinkProgram(program);
    static char text[1024];
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked), glGetProgramInfoLog(program, sizeof text, NULL, text);
    expect(linked, text);
    return program;
}
static GLFWwindow* make_window(void) {
    expect(glfwInit(), "GLFW does not start: use --headless");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4), glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    GLFWwindow* window = glfwCreateWindow(WIDTH, HEIGHT, "Tears in a host", NULL, NULL);
    expect(window != NULL, "there is no window with OpenGL 4.5: use --headless");
    glfwMakeContextCurrent(window);
    return window;
}
static void make_headless(void) {
    const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    expect(display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL) && eglBindAPI(EGL_OPENGL_API), "EGL does not start");
    const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    expect(context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context), "EGL has no OpenGL 4.5");
    GLuint framebuffer = 0, parts[2] = {0, 0};
    glCreateFramebuffers(1, &framebuffer), glCreateRenderbuffers(2, parts);
    for (int k = 0; k < 2; ++k) {
        glNamedRenderbufferStorage(parts[k], k == 0 ? GL_RGBA8 : GL_DEPTH_COMPONENT24, WIDTH, HEIGHT);
        glNamedFramebufferRenderbuffer(framebuffer, k == 0 ? GL_COLOR_ATTACHMENT0 : GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts[k]);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer), glViewport(0, 0, WIDTH, HEIGHT);
}
/* A dome of 12 cm x 12 cm that stands, 2 cm deep, with its uvs from 0 to 1: its vertices as vec4, uvs and triangles. */
static float rest[4 * VERTICES], positions[3 * VERTICES], uvs[2 * VERTICES];
static uint32_t indices[INDICES];
static void make_mesh(void) {
    for (int k = 0; k < VERTICES; ++k) {
        const float u = (float)(k % SIDE) / (SIDE - 1), v = (float)(k / SIDE) / (SIDE - 1), x = u - 0.5F, y = v - 0.5F;
        const float place[4] = {0.12F * x, 0.12F * y, 0.02F - 0.04F * (x * x + y * y), 1};
        memcpy(rest + 4 * k, place, sizeof place);
        memcpy(positions + 3 * k, place, 3 * sizeof *place);
        uvs[2 * k] = u, uvs[2 * k + 1] = v;
    }
    for (uint32_t y = 0, *to = indices; y + 1 < SIDE; ++y)
        for (uint32_t x = 0; x + 1 < SIDE; ++x, to += 6) {
            const uint32_t low = y * SIDE + x, high = low + SIDE, both[6] = {low, low + 1, high + 1, low, high + 1, high};
            memcpy(to, both, sizeof both);
        }
}
/* Prints what tests/embed/skin reads: the drop at uv (0.3, 0.6), which is held, where it is in the world; the map; the ledger. */
static void report(rivulet_skin* skin, GLuint map, GLuint moved) {
    static float texels[MAP * MAP][4], places[VERTICES][4];
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetTextureImage(map, 0, GL_RGBA, GL_FLOAT, sizeof texels, texels);
    glGetNamedBufferSubData(moved, 0, sizeof places, places);
    int wet = 0;
    double u = 0, v = 0, held = 0, low = 1;
    for (int k = 0; k < MAP * MAP; ++k) {
        const double s = (k % MAP + 0.5) / MAP, t = (k / MAP + 0.5) / MAP, height = (double)texels[k][2];
        wet += texels[k][3] > 0.5F;
        if (height > 0.05 && s > 0.5 && t < low) low = t;
        if (s < 0.5) u += s * height, v += t * height, held += height;
    }
    if (held > 0) u /= held, v /= held;
    const float* p = places[(int)lround(v * (SIDE - 1)) * SIDE + (int)lround(u * (SIDE - 1))];
    rivulet_skin_stats s = {.size = sizeof s};
    done(rivulet_skin_stats_of(skin, &s, &why));
    printf("wet texels %d\nheld drop uv %.4f %.4f world %.5f %.5f %.5f\nrunning drop v %.4f\n", wet, u, v, (double)p[0], (double)p[1],
           (double)p[2], low);
    printf("drops %d, added %.3f ul, on skin %.3f ul, ledger error %.0f pl\n", (int)s.drops, 1e9 * s.added, 1e9 * s.on_skin,
           1e15 * (s.added - s.on_skin - s.left - s.evaporated - s.refused));
}
static void write_picture(const char* path) {
    static unsigned char pixels[HEIGHT][3 * WIDTH];
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, pixels);
    FILE* file = fopen(path, "wb");
    expect(file != NULL && fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT) > 0, path);
    for (int row = HEIGHT - 1; row >= 0; --row) fwrite(pixels[row], sizeof *pixels, 1, file);
    fclose(file);
}
int main(int count, char** arguments) {
    int frames = -1, dry = 0, headless = 0;
    const char *picture = NULL, *backend = NULL;
    for (int k = 1; k < count; ++k) {
        dry = dry || strcmp(arguments[k], "--dry") == 0;
        headless = headless || strcmp(arguments[k], "--headless") == 0;
        if (strcmp(arguments[k - 1], "--frames") == 0) frames = atoi(arguments[k]);
        if (strcmp(arguments[k - 1], "--out") == 0) picture = arguments[k];
        if (strcmp(arguments[k - 1], "--backend") == 0) backend = arguments[k];
    }
    expect(!headless || frames > 0, "--headless needs --frames");
    GLFWwindow* window = headless ? NULL : make_window();
    if (headless) make_headless();
    make_mesh();
    const GLuint deform = program_of(1, (GLenum[]){GL_COMPUTE_SHADER}, &deform_source);
    const GLuint material = program_of(2, (GLenum[]){GL_VERTEX_SHADER, GL_FRAGMENT_SHADER}, (const char*[]){vertex_source, tears_source});
    GLuint buffers[4], array = 0; /* rest, moved, uvs, indices */
    glCreateBuffers(4, buffers);
    const void* const contents[4] = {rest, NULL, uvs, indices};
    const GLsizeiptr sizes[4] = {sizeof rest, sizeof rest, sizeof uvs, sizeof indices};
    for (int k = 0; k < 4; ++k) glNamedBufferStorage(buffers[k], sizes[k], contents[k], 0);
    glCreateVertexArrays(1, &array);
    glVertexArrayVertexBuffer(array, 0, buffers[2], 0, 8), glVertexArrayElementBuffer(array, buffers[3]);
    glEnableVertexArrayAttrib(array, 0), glVertexArrayAttribFormat(array, 0, 2, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(array, 1, buffers[1], 0, 16), glEnableVertexArrayAttrib(array, 1);
    glVertexArrayAttribFormat(array, 1, 3, GL_FLOAT, GL_FALSE, 0), glVertexArrayAttribBinding(array, 1, 1);

    rivulet_context* context = NULL;
    const rivulet_context_options options = {.size = sizeof options, .find = headless ? eglGetProcAddress : glfwGetProcAddress,
                                             .backend = backend, .log = hear};
    done(rivulet_context_create(&options, &context, &why));
    const rivulet_mesh mesh = {.size = sizeof mesh, .positions = positions, .vertices = VERTICES, .indices = indices,
                               .indices_count = INDICES, .uvs = uvs};
    const rivulet_skin_options skin_options = {.size = sizeof skin_options, .mesh = &mesh, .map_size = MAP};
    rivulet_skin* skin = NULL;
    done(rivulet_skin_create(context, &skin_options, &skin, &why));
    /* From 0.38 m away, 20 degrees down; 30 degrees high. */
    const float si = 0.3420F, co = 0.9397F, cot = 3.732F, away = 0.38F, far_plane = 2, near_plane = 0.05F;
    const float depth = (near_plane + far_plane) / (near_plane - far_plane), shift = 2 * near_plane * far_plane / (near_plane - far_plane);
    const float clip_from_world[16] = {cot, 0, 0, 0, 0, cot * co, depth * si, -si,
                                       0, -cot * si, depth * co, -co, 0, 0, shift - depth * away, away};
    glEnable(GL_DEPTH_TEST), glClearColor(0.86F, 0.88F, 0.90F, 1);
    for (int frame = 0; frame != frames && (headless || !glfwWindowShouldClose(window)); ++frame) {
        glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 2, buffers);
        glUseProgram(deform);
        glUniform1f(glGetUniformLocation(deform, "seconds"), (float)frame / 60);
        glDispatchCompute((VERTICES + 63) / 64, 1, 1);

        if (frame == 0 && !dry) { /* places on the mesh as it was given: the skin has this shape until its first step */
            done(rivulet_skin_add(skin, (const float[]){-0.024F, 0.012F, 0.02F}, 2, &why)); /* at uv (0.3, 0.6); it is held */
            done(rivulet_skin_add(skin, (const float[]){0.024F, 0.03F, 0.02F}, 14, &why));  /* at uv (0.7, 0.75); it runs */
        }
        const rivulet_skin_inputs inputs = {.size = sizeof inputs, .positions_buffer = buffers[1]};
        uint32_t map = 0;
        done(rivulet_skin_step(skin, &inputs, 1.0 / 60, &why));
        done(rivulet_skin_texture(skin, &map, &why));
        glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT); /* for the host's own vertex shader, which reads the buffer */
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        glUseProgram(material);
        glUniformMatrix4fv(glGetUniformLocation(material, "clip_from_world"), 1, GL_FALSE, clip_from_world);
        glUniform3f(glGetUniformLocation(material, "eye"), 0, away * si, away * co);
        glUniform3f(glGetUniformLocation(material, "to_light"), 0.25F, -0.15F, 0.957F);
        glBindTextureUnit(0, map);
        glBindVertexArray(array);
        glDrawElements(GL_TRIANGLES, INDICES, GL_UNSIGNED_INT, NULL);
        if (frame + 1 == frames) report(skin, map, buffers[1]);
        if (frame + 1 == frames && picture != NULL) write_picture(picture);
        if (window != NULL) glfwSwapBuffers(window), glfwPollEvents();
        expect(glGetError() == GL_NO_ERROR, "glGetError reports an error");
    }
    rivulet_skin_destroy(skin), rivulet_context_destroy(context); /* while its OpenGL context still exists */
    if (window != NULL) glfwTerminate();
}
