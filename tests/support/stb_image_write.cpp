// SPDX-License-Identifier: Apache-2.0
// stb_image_write, by which tests make files for the decoders.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
