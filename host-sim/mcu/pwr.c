#include "mcu/pwr.h"

#include "mcu/soc.h"

#define CR_LPDS_PDDS 0x3U
#define CR_PVDE      (UINT32_C(1) << 4)
#define CR_DBP       (UINT32_C(1) << 8)
#define CR_VOS       (UINT32_C(1) << 14)
#define CR_BITS      0x43F3U
#define CSR_ENABLES  0x300U
#define CSR_VOSRDY   (UINT32_C(1) << 14)
#define CSR_BRR      (UINT32_C(1) << 3)
#define CSR_BRE      (UINT32_C(1) << 9)

void pwr_reset(struct pwr *pwr, struct soc *soc) {
    *pwr = (struct pwr){.soc = soc, .cr = CR_VOS};
}

bool pwr_scale_one(const struct pwr *pwr) {
    return (pwr->cr & CR_VOS) != 0U;
}

bool pwr_backup_writable(const struct pwr *pwr) {
    return (pwr->cr & CR_DBP) != 0U;
}

uint32_t pwr_read(void *model, uint32_t offset) {
    const struct pwr *pwr = model;
    switch (offset) {
    case 0x0:
        return pwr->cr;
    case 0x4: // the regulators follow at once
        return pwr->csr | CSR_VOSRDY | ((pwr->csr & CSR_BRE) != 0U ? CSR_BRR : 0U);
    default:
        return 0;
    }
}

void pwr_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct pwr *pwr = model;
    (void)lanes;
    if (offset == 0x4U) {
        pwr->csr = value & CSR_ENABLES;
    }
    if (offset != 0U) {
        return;
    }
    if ((value & (CR_LPDS_PDDS | CR_PVDE)) != 0U) {
        soc_complain(pwr->soc, "low-power modes and the voltage detector have no model");
    }
    pwr->cr = value & CR_BITS; // CWUF and CSBF only clear
    rcc_check_limits(&pwr->soc->rcc);
}
