#include "view/style.h"

/// Faces that common systems have; no face is loaded from anywhere.
#define SANS "system-ui,\"Segoe UI\",Roboto,\"Helvetica Neue\",\"DejaVu Sans\",Arial,sans-serif"

/// Shapes of a picture's parts; their colours follow.
#define PICTURE_SHAPES                                                                             \
    ".background,.solid{fill:none;stroke-linecap:round}.solid{stroke-width:.9}\n"                  \
    ".frame,.bracket,.cone,.miss,.boresight,.scale{fill:none}\n"                                   \
    ".frame{stroke-width:1}.bracket{stroke-width:2.5}\n"                                           \
    ".cone{stroke-width:1.6}.miss{stroke-width:1}\n"                                               \
    ".boresight{stroke-width:1.4}.scale{stroke-width:1.2}\n"                                       \
    ".target{stroke-width:4;stroke-opacity:.22}\n"                                                 \
    ".lost{fill:none;stroke-width:1.4;stroke-opacity:1}\n"                                         \
    ".label{font-size:11px;stroke-width:2.6px;stroke-linejoin:round;paint-order:stroke}\n"         \
    ".quiet{font-size:10.5px}\n"

const char style_page[] =
    ":root{color-scheme:light dark;--ground:#fdfdfc;--ink:#1c2127;--quiet:#5a646e;--rule:#d9dde1;"
    "--grid:#e8ebee;--actual:#00588c;--setpoint:#f5b57c;--link:#005a8d;\n"
    "--beside:#eef0f2;--sensor:#fff;--background:#98a1ab;--frame:#4d5761;--cone:#c44f00;"
    "--target:#00558a;--cross:#1c2127;--lost:#b3005e}\n"
    "@media screen and (prefers-color-scheme:dark){:root{--ground:#12161b;--ink:#e4e7ea;"
    "--quiet:#9ba5af;--rule:#333b44;--grid:#242b32;--actual:#7cc8f5;--setpoint:#8f5a16;"
    "--link:#7cc4ee;\n"
    "--beside:#0b0e12;--sensor:#0f1824;--background:#8494a5;--frame:#8b97a3;--cone:#56b4e9;"
    "--target:#ffd76a;--cross:#f2f4f6;--lost:#ff8fc0}}\n"
    "*{box-sizing:border-box}\n"
    "body{margin:0 auto;padding:2.5rem clamp(1rem,4vw,3rem) 4rem;max-width:74rem;"
    "background:var(--ground);color:var(--ink);font:1rem/1.55 " SANS ";"
    "font-variant-numeric:tabular-nums}\n"
    "h1,h2{font-family:Charter,\"Bitstream Charter\",\"Iowan Old Style\",Cambria,Georgia,"
    "\"DejaVu Serif\",serif;font-weight:600;line-height:1.2;text-wrap:balance}\n"
    "h1{font-size:2.1rem;margin:0 0 .3rem}h2{font-size:1.6rem;margin:0 0 .2rem}\n"
    "h3{font-size:1.05rem;margin:2.2rem 0 .7rem}\n"
    "a{color:var(--link)}\n"
    "header{padding-bottom:1.2rem;border-bottom:2px solid var(--ink)}\n"
    "header p{margin:.2rem 0;color:var(--quiet)}\n"
    "nav ol{margin:.8rem 0 0;padding-left:1.4rem}\n"
    "section{margin-top:3rem}\n"
    ".subtitle{margin:0;text-wrap:balance;color:var(--quiet);font-size:1.05rem;max-width:46rem}\n"
    ".facts{display:grid;grid-template-columns:repeat(auto-fill,minmax(12.5rem,1fr));"
    "column-gap:2rem;margin:1.4rem 0 0}\n"
    ".facts div{padding:.5rem 0 .55rem;border-top:1px solid var(--rule)}\n"
    "dt{color:var(--quiet);font-size:.82rem;line-height:1.3}\n"
    "dd{margin:0;overflow-wrap:anywhere}\n"
    "figure{margin:0}\n"
    "figcaption{color:var(--quiet);font-size:.88rem;line-height:1.45}\n"
    ".wide{overflow-x:auto}\n"
    ".plot{display:block;width:100%;min-width:40rem;height:auto}\n"
    "svg text{font-family:" SANS ";fill:var(--ink)}\n"
    ".plot .heading{font-size:13px;font-weight:600}\n"
    ".plot .tick{font-size:12px;fill:var(--quiet)}\n"
    ".plot .number{font-size:11px;fill:var(--link)}\n"
    ".plot .stay{font-size:11.5px;fill:#111}\n"
    ".grid{stroke:var(--grid);stroke-width:1;fill:none}\n"
    ".axis{stroke:var(--quiet);stroke-width:1;fill:none}\n"
    ".mark{stroke:var(--quiet);stroke-width:1;stroke-dasharray:1 4;fill:none}\n"
    ".actual,.setpoint{fill:none;stroke-linejoin:round;stroke-linecap:round}\n"
    ".actual{stroke:var(--actual);stroke-width:1.5}\n"
    ".setpoint{stroke:var(--setpoint);stroke-width:5}\n"
    ".mode0{fill:#8c8c8c}.mode1{fill:#c9c9c9}.mode2{fill:#f0e442}.mode3{fill:#35b78f}"
    ".mode4{fill:#56b4e9}.mode5{fill:#cc79a7}.mode6{fill:#e8590c}\n"
    ".mode7{fill:#a6a1e0}.mode8{fill:#d9b38c}.mode9{fill:#9fd3c7}.mode10{fill:#e9c7dd}"
    ".mode11{fill:#b5c27a}\n"
    ".legend{display:flex;flex-wrap:wrap;gap:.2rem 1.3rem;margin:0 0 .4rem;font-size:.88rem}\n"
    ".legend span{white-space:nowrap}\n"
    ".legend svg{height:.65rem;width:auto;margin-right:.4rem}\n"
    ".legend small{color:var(--quiet);font-size:1em}\n"
    ".pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(21rem,100%),1fr));"
    "gap:2rem 1.8rem;align-items:start}\n"
    ".pictures+.legend{margin-top:1.6rem}\n"
    ".picture{scroll-margin-top:1rem}\n"
    ".picture svg{display:block;width:100%;height:auto;background:var(--beside);"
    "border:1px solid var(--rule);border-radius:4px}\n"
    ".picture h4{margin:.55rem 0 .25rem;font-size:1rem;line-height:1.3;color:var(--ink)}\n"
    ".picture h4 span{color:var(--quiet);font-weight:400;margin-right:.5em}\n"
    ".picture dl{display:grid;grid-template-columns:repeat(3,1fr);gap:.3rem .8rem;margin:0}\n"
    ".picture dd{color:var(--ink)}\n"
    ".picture p{margin:.35rem 0 0}\n" PICTURE_SHAPES
    ".sensor{fill:var(--sensor)}.veil{fill:var(--beside);fill-opacity:.78}"
    ".strip{fill:var(--beside)}\n"
    ".background{stroke:var(--background)}.solid{stroke:var(--quiet)}.frame,.bracket{stroke:var(--"
    "frame)}\n"
    ".cone,.miss{stroke:var(--cone)}.cone-axis{fill:var(--cone);stroke:none}\n"
    ".boresight,.scale{stroke:var(--cross)}.target{fill:var(--target);stroke:var(--target)}\n"
    ".lost{fill:none;stroke:var(--lost)}\n"
    ".label{stroke:var(--sensor)}svg .quiet{fill:var(--quiet)}\n"
    "footer{margin-top:3.5rem;padding-top:.7rem;border-top:1px solid var(--rule);"
    "color:var(--quiet);font-size:.85rem}\n"
    "@media print{@page{margin:14mm}:root{font-size:9pt;--ground:#fff}"
    "body{max-width:none;padding:0}"
    "section{break-before:page}section:first-of-type{break-before:auto}"
    "h2,h3{break-after:avoid}figure,.facts "
    "div{break-inside:avoid}.plot{min-width:0;width:86%;margin:0 auto}"
    ".pictures{grid-template-columns:repeat(2,1fr)}a{color:inherit;text-decoration:none}}\n";

const char style_picture[] =
    "text{font-family:" SANS ";fill:#e4e7ea}\n"
    ".card{fill:#12161b}.edge{fill:none;stroke:#3c454f}\n"
    ".title{font-weight:600}.fact{font-size:12px}.name{fill:#9ba5af}\n" PICTURE_SHAPES
    ".sensor{fill:#0f1824}.veil{fill:#0b0e12;fill-opacity:.78}.strip{fill:#0b0e12}\n"
    ".background{stroke:#93a3b5}.solid{stroke:#93a3b5}.frame,.bracket{stroke:#8b97a3}\n"
    ".cone,.miss{stroke:#56b4e9}.cone-axis{fill:#56b4e9}\n"
    ".boresight,.scale{stroke:#f2f4f6}.target{fill:#ffd76a;stroke:#ffd76a}\n"
    ".lost{fill:none;stroke:#ff8fc0}\n"
    ".label{stroke:#0f1824}.quiet{fill:#9ba5af}\n";
