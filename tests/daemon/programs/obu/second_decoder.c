/* SPDX-License-Identifier: Apache-2.0 */
/* A second reader of J2735, made by asn1c from second_decoder.asn: hex lines of MessageFrames in, one
 * line of 25 whole numbers each out, or "refused". */
#include <stdio.h>
#include <string.h>

#include "Bsm.h"
#include "Frame.h"

static int Digit(int letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  return -1;
}

static int Print(const unsigned char* bytes, size_t size) {
  Frame_t* frame = NULL;
  Bsm_t* bsm = NULL;
  int is_good = 0;
  asn_dec_rval_t got =
      uper_decode(NULL, &asn_DEF_Frame, (void**)&frame, bytes, size, 0, 0);
  if (got.code == RC_OK && frame->mid == 20) {
    got = uper_decode(NULL, &asn_DEF_Bsm, (void**)&bsm, frame->body.buf,
                      (size_t)frame->body.size, 0, 0);
    /* The decoder lets codes above a range through; the check of constraints does not. */
    if (got.code == RC_OK && asn_check_constraints(&asn_DEF_Bsm, bsm, NULL, NULL) == 0) {
      const Core_t* c = &bsm->core;
      is_good = 1;
      printf("%ld %lu %ld %ld %ld %ld %ld %ld %ld %ld %ld %ld %ld %ld %ld %ld %ld %d %ld %ld %ld %ld"
             " %ld %ld %ld\n",
             c->cnt,
             (unsigned long)c->tid.buf[0] << 24 | (unsigned long)c->tid.buf[1] << 16 |
                 (unsigned long)c->tid.buf[2] << 8 | (unsigned long)c->tid.buf[3],
             c->sec, c->la, c->lo, c->el, c->acc.major, c->acc.minor, c->acc.ori, c->trans, c->spd,
             c->hdg, c->ang, c->acl.lon, c->acl.lat, c->acl.ver, c->acl.yaw, c->brk.whl.buf[0] >> 3,
             c->brk.trac, c->brk.ab, c->brk.sc, c->brk.boost, c->brk.aux, c->siz.wid, c->siz.len);
    }
  }
  ASN_STRUCT_FREE(asn_DEF_Frame, frame);
  ASN_STRUCT_FREE(asn_DEF_Bsm, bsm);
  return is_good;
}

int main(void) {
  static char line[8192];
  static unsigned char bytes[4096];
  while (fgets(line, sizeof line, stdin) != NULL) {
    size_t size = 0;
    const char* at = line;
    for (; Digit(at[0]) >= 0 && Digit(at[1]) >= 0; at += 2) {
      bytes[size++] = (unsigned char)(Digit(at[0]) * 16 + Digit(at[1]));
    }
    if (!Print(bytes, size)) puts("refused");
  }
  return 0;
}
