//! The head of a calibration page: title, style for both colour schemes, and policy.

use super::super::html::{escape, policy};

/// Colours are variables for both schemes; the figures, drawn on white, are inverted in the dark
/// one.
const STYLE: &str = "\
:root{color-scheme:light dark;--page:#fff;--ink:#222;--soft:#555;--line:#ccc;--rule:#dde5ec;--box:#eef3f8;--before:#a8460f;\
--after:#005a9c;--selected:#e6f0f8;--rival:#fbf1e8;--band:#e4eaf0}\
@media(prefers-color-scheme:dark){:root{--page:#14181c;--ink:#e2e6ea;--soft:#a4adb6;--line:#3c444c;--rule:#2c343c;--box:#1d252d;\
--before:#f09a62;--after:#74b8f0;--selected:#1c3044;--rival:#3a2a1c;--band:#2a323a}\
figure.plot svg{filter:invert(.92) hue-rotate(180deg)}}\
body{font:16px/1.5 sans-serif;max-width:940px;margin:2em auto;padding:0 1em;color:var(--ink);background:var(--page);\
overflow-wrap:break-word}\
h2{margin-top:2em;border-bottom:2px solid var(--rule);padding-bottom:.2em}\
.wide{overflow-x:auto}table{border-collapse:collapse;margin:1em 0}\
td,th{border-bottom:1px solid var(--line);padding:.25em .8em;text-align:left;vertical-align:top;overflow-wrap:normal}\
td.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}\
.verdict{background:var(--box);padding:.1em 1em;border-left:5px solid var(--after)}.verdict table{margin:.4em 0}\
figure{margin:.6em 0}.grid{display:grid;grid-template-columns:1fr 1fr;gap:.4em}.grid figure{margin:0}\
@media(max-width:640px){.grid{grid-template-columns:1fr}td,th{padding:.25em .5em}.wide td:not(.n){min-width:7em}}\
figcaption,.soft,tr.soft td{color:var(--soft)}svg{max-width:100%;height:auto}.b{color:var(--before)}.a{color:var(--after)}\
\
.bars td.bar{width:45%;min-width:5em;padding-top:.55em}.bars svg{display:block;width:100%;height:.9em}.bars rect{fill:var(--soft)}\
.bars .selected rect{fill:var(--after)}.bars .rival rect{fill:var(--before)}.bars rect.track{fill:var(--band)}\
.bars .rival td:first-child{padding-left:1.6em}\
@media(max-width:640px){.broad{overflow-x:auto}.broad svg{max-width:none;width:640px}}\
@media(max-width:640px){.verdict table{font-size:.85em}.verdict td,.verdict th{padding:.25em .35em}.verdict .wide td:not(.n){min-width:5em}\
.bars{font-size:.82em;width:100%}.bars th,.bars td{padding:.25em .25em}.wide .bars td:not(.n){min-width:0}\
.bars td.bar{width:16%;padding-top:.5em}}\
tr.selected td{background:var(--selected)}tr.rival td{background:var(--rival)}\
.strip{width:700px;min-width:320px;fill:var(--ink);font:13px sans-serif}.strip .band{fill:var(--band)}.strip .zero{stroke:var(--soft)}\
.strip .open{stroke:var(--before)}.strip .excluded{stroke:var(--soft)}.strip .quiet{fill:var(--soft)}";

/// Returns everything before the first heading of a page.
pub(in super::super) fn head(title: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>{}</title><style>{STYLE}</style></head><body>\n",
        policy(&[]),
        escape(title)
    )
}
