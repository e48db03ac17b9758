/// The style sheets. Colours are those of Okabe and Ito, which people who see red and green alike
/// can tell apart; lines differ in thickness, too.
#ifndef VIEW_STYLE_H
#define VIEW_STYLE_H

extern const char style_page[];    ///< of the report: light and dark, screen and paper
extern const char style_picture[]; ///< of a picture in a file of its own: plain colours on its own
                                   ///< ground, because not every viewer of SVG knows variables

#endif
