/* Water in a host in C with SDL2 and OpenGL's fixed-function pipeline (a compatibility context), through rivulet.h.
 * embed_sdl2 [--frames N] [--picture FILE.ppm] [--dry]: stops after N frames and writes the last one; --dry draws no water. */
#include <SDL.h>
#include <SDL_opengl.h>
#include <math.h>
#include <rivulet/rivulet.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 640, HEIGHT = 480 };
static rivulet_error why;
static void expect(int fine, const char* what) { if (!fine) exit(fprintf(stderr, "embed_sdl2: %s\n", what) > 0); }
static rivulet_function find(const char* name) {
    union { void* found; rivulet_function function; } as = {SDL_GL_GetProcAddress(name)};
    return as.function;
}
/* A parallelogram of u x v tiles in two colours. */
static void tiles(const float* at, const float* u, int nu, const float* v, int nv, const float* one, const float* other) {
    glNormal3f(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    glBegin(GL_QUADS);
    for (int k = 0; k < 4 * nu * nv; ++k) {
        const int tile = k / 4, corner = k % 4;
        const float a = (float)(tile % nu + (corner == 1 || corner == 2)) / (float)nu, b = (float)(tile / nu + corner / 2) / (float)nv;
        glColor3fv((tile % nu + tile / nu) % 2 ? one : other);
        glVertex3f(at[0] + a * u[0] + b * v[0], at[1] + a * u[1] + b * v[1], at[2] + a * u[2] + b * v[2]);
    }
    glEnd();
}
/* A round post of `height` on (x, y, z). */
static void post(float x, float y, float z, float radius, float height, const float* colour) {
    glColor3fv(colour);
    for (int cap = 0; cap < 2; ++cap) {
        glBegin(cap ? GL_TRIANGLE_FAN : GL_QUAD_STRIP);
        for (int k = 0; k <= 48; ++k) {
            const float c = cosf((float)k * 0.1308997F), s = -sinf((float)k * 0.1308997F);
            glNormal3f(cap ? 0 : c, (float)cap, cap ? 0 : s);
            glVertex3f(x + radius * c, y + height, z + radius * s);
            if (!cap) glVertex3f(x + radius * c, y, z + radius * s);
        }
        glEnd();
    }
}
/* A pool of 1.2 m in a terrace, its front of glass, a mosaic and a pole in it, and a post before it. */
static void draw_host(void) {
    const float y[3] = {0, 0.42F, 0}, x[3] = {1.2F, 0, 0}, back_z[3] = {0, 0, -1.2F}, z[3] = {0, 0, 1.2F};
    const float a[3] = {0.72F, 0.86F, 0.86F}, b[3] = {0.84F, 0.93F, 0.92F}, deck[3] = {0.86F, 0.80F, 0.71F}, dark[3] = {0.80F, 0.74F, 0.65F};
    const float blue[3] = {0.16F, 0.33F, 0.62F}, gold[3] = {0.93F, 0.70F, 0.22F}, red[3] = {0.78F, 0.24F, 0.16F};
    tiles((float[]){0, 0, 1.2F}, x, 16, back_z, 16, a, b);
    tiles((float[]){0.3F, 0.002F, 0.9F}, (float[]){0.6F, 0, 0}, 8, (float[]){0, 0, -0.6F}, 8, blue, b);
    tiles((float[]){0, 0, 0}, x, 16, y, 6, a, b);
    tiles((float[]){0, 0, 1.2F}, back_z, 16, y, 6, a, b);
    tiles((float[]){1.2F, 0, 0}, z, 16, y, 6, a, b);
    const float flat[4][5] = {{-9, 10.2F, -9, 0, 0.42F}, {-9, 0, 0, 1.2F, 0.42F}, {1.2F, 10.2F, 0, 1.2F, 0.42F}, {-9, 10.2F, 1.2F, 3, 0}};
    for (const float* f = flat[0]; f <= flat[3]; f += 5)
        tiles((float[]){f[0], f[4], f[3]}, (float[]){f[1] - f[0], 0, 0}, (int)lroundf((f[1] - f[0]) / 0.2F), (float[]){0, 0, f[2] - f[3]},
              (int)lroundf((f[3] - f[2]) / 0.2F), deck, dark);
    for (int k = 0; k < 2; ++k) tiles((float[]){k ? 1.2F : -2.4F, 0, 1.2F}, (float[]){2.4F, 0, 0}, 12, y, 2, deck, dark);
    post(0.14F, 0, 1.42F, 0.05F, 0.27F, red);
    post(0.72F, 0, 0.40F, 0.016F, 0.80F, gold);
}
int main(int count, char** arguments) {
    int frames = -1, dry = 0;
    const char* picture = NULL; /* file for the last frame */
    for (int k = 1; k < count; ++k) {
        dry = dry || SDL_strcmp(arguments[k], "--dry") == 0;
        if (SDL_strcmp(arguments[k - 1], "--frames") == 0) frames = SDL_atoi(arguments[k]);
        if (SDL_strcmp(arguments[k - 1], "--picture") == 0) picture = arguments[k];
    }
    expect(SDL_Init(SDL_INIT_VIDEO) == 0, SDL_GetError());
    const int attributes[][2] = {{SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_COMPATIBILITY}, {SDL_GL_CONTEXT_MAJOR_VERSION, 4},
        {SDL_GL_CONTEXT_MINOR_VERSION, 5}, {SDL_GL_DEPTH_SIZE, 24}, {SDL_GL_MULTISAMPLEBUFFERS, 1}, {SDL_GL_MULTISAMPLESAMPLES, 4}};
    for (int k = 0; k < 6; ++k) SDL_GL_SetAttribute((SDL_GLattr)attributes[k][0], attributes[k][1]);
    SDL_Window* window = SDL_CreateWindow("Rivulet in SDL2", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, WIDTH, HEIGHT, SDL_WINDOW_OPENGL);
    expect(window != NULL && SDL_GL_CreateContext(window) != NULL, SDL_GetError());
    const float near_plane = 0.1F, far_plane = 15, cot = 2.6F; /* from (0.6, 1.05, 2.75), 22.6 degrees down */
    const float view[16] = {1, 0, 0, 0, 0, 0.9231F, 0.3846F, 0, 0, -0.3846F, 0.9231F, 0, -0.6F, 0.0885F, -2.9423F, 1};
    const float projection[16] = {cot * HEIGHT / WIDTH, 0, 0, 0, 0, cot, 0, 0, 0, 0, (near_plane + far_plane) / (near_plane - far_plane), -1,
                                  0, 0, 2 * near_plane * far_plane / (near_plane - far_plane), 0};
    rivulet_context* context = NULL;
    const rivulet_context_options options = {.size = sizeof options, .find = find, .clouds = 0.3F,
                                             .sky_horizon = {0.55F, 0.66F, 0.76F}, .sky_zenith = {0.20F, 0.34F, 0.56F}};
    expect(rivulet_context_create(&options, &context, &why) == RIVULET_OK, why.message);
    const rivulet_world_options scene = {.size = sizeof scene, .json =
        "{\"fluid\": {\"spacing\": 0.025, \"box\": {\"max\": [1.2, 1.2, 1.2]}, \"blocks\": [{\"max\": [1.2, 0.3, 1.2]},"
        " {\"shape\": \"ball\", \"min\": [0.25, 0.5, 0.45], \"max\": [0.55, 0.8, 0.75]}]}}"};
    rivulet_world* world = NULL;
    expect(rivulet_world_create(context, &scene, &world, &why) == RIVULET_OK, why.message);
    const rivulet_view from = {.size = sizeof from, .view = view, .projection = projection, .near_plane = near_plane, .far_plane = far_plane};
    const rivulet_target target = {.size = sizeof target, .width = WIDTH, .height = HEIGHT};
    /* Set once: drawing water restores this state. */
    const GLenum on[] = {GL_DEPTH_TEST, GL_CULL_FACE, GL_LIGHTING, GL_LIGHT0, GL_COLOR_MATERIAL, GL_NORMALIZE};
    for (int k = 0; k < 6; ++k) glEnable(on[k]);
    glClearColor(0.66F, 0.79F, 0.90F, 1);
    glLightModelfv(GL_LIGHT_MODEL_AMBIENT, (float[]){0.34F, 0.36F, 0.40F, 1});
    glLightfv(GL_LIGHT0, GL_DIFFUSE, (float[]){0.72F, 0.70F, 0.65F, 1});
    glMatrixMode(GL_PROJECTION), glLoadMatrixf(projection);
    glMatrixMode(GL_MODELVIEW), glLoadMatrixf(view);
    glLightfv(GL_LIGHT0, GL_POSITION, (float[]){0.4F, 0.8F, 0.45F, 0});
    for (int frame = 0, open = 1; open && frame != frames; ++frame) {
        for (SDL_Event event; SDL_PollEvent(&event);) open = open && event.type != SDL_QUIT;
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        draw_host();
        expect(rivulet_world_step(world, NULL, 1.0 / 60, &why) == RIVULET_OK, why.message);
        expect(dry || rivulet_world_draw(world, &from, &target, &why) == RIVULET_OK, why.message);
        if (frame + 1 == frames && picture != NULL) {
            static unsigned char pixels[HEIGHT][3 * WIDTH];
            glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, pixels);
            FILE* file = fopen(picture, "wb");
            expect(file != NULL && fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT) > 0, picture);
            for (int row = HEIGHT - 1; row >= 0; --row) fwrite(pixels[row], sizeof *pixels, 1, file);
            fclose(file);
        }
        SDL_GL_SwapWindow(window);
        expect(glGetError() == GL_NO_ERROR, "glGetError reports an error");
    }
    rivulet_world_destroy(world);
    rivulet_context_destroy(context); /* while its OpenGL context still exists */
    SDL_Quit();
}
