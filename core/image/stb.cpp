// stb_image and stb_image_write, compiled once for everyone: PNG, JPEG and HDR from and to memory. (Without
// stdio stb_image_write leaves its HDR writer out, even the one into memory.)
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
// Broken files make stb_image read tables that it never filled, and fail its assertions: they shall give the same
// pixels everywhere, and never end the program.
#include <stdlib.h>
#define STBI_MALLOC(size) calloc(1, size)
#define STBI_REALLOC(memory, size) realloc(memory, size)
#define STBI_FREE(memory) free(memory)
#define STBI_ASSERT(condition) ((void)0)
#include <stb_image.h>

// Without standard I/O, which we do not use, it would leave out the writer of HDR.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
