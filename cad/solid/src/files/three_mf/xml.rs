//! A streaming XML reader with a bound on everything that costs: depth, attributes, namespaces.
//!
//! It reads the XML that 3MF allows: UTF-8 without a document type declaration, so that there are no
//! entities to expand. The time is linear in the length of the text.

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

/// Deepest nesting of elements. The core specification needs eight.
const MAX_DEPTH: usize = 64;
/// Most attributes of an element. The core specification has at most seven, slicers add a few.
const MAX_ATTRIBUTES: usize = 32;
/// Most namespace declarations in scope.
const MAX_DECLARATIONS: usize = 64;
/// Most different namespaces of a document.
const MAX_NAMESPACES: usize = 256;
/// Longest namespace, and longest name of an element or an attribute, in bytes.
pub(super) const MAX_NAME_BYTES: usize = 2048;
/// Namespace that the prefix `xml` denotes without a declaration.
const XML: &str = "http://www.w3.org/XML/1998/namespace";

/// Index of a namespace in the order of the first declarations.
pub(super) type NamespaceId = u32;

/// Why a document cannot be read.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum XmlError {
    /// The text is not the XML that 3MF allows: the line from 1, and the problem.
    Malformed(usize, String),
    /// A bound is exceeded.
    Bound(String),
}

/// An attribute, without namespace declarations.
#[derive(Clone, Debug)]
pub(super) struct Attribute<'a> {
    pub(super) namespace: Option<NamespaceId>,
    pub(super) name: &'a str,
    pub(super) value: Cow<'a, str>,
}

/// A part of a document.
#[derive(Debug)]
pub(super) enum Event<'a> {
    /// The start of an element; its attributes are in [`XmlReader::attributes`].
    Start { namespace: Option<NamespaceId>, name: &'a str },
    /// The end of an element.
    End,
    /// Text between tags.
    Text(Cow<'a, str>),
    /// The end of the document.
    Eof,
}

/// Reads a document event by event.
pub(super) struct XmlReader<'a> {
    text: &'a str,
    at: usize,
    /// Attributes of the last start tag.
    pub(super) attributes: Vec<Attribute<'a>>,
    /// Prefixes in scope, the innermost last.
    scope: Vec<(&'a str, Option<NamespaceId>)>,
    /// Namespaces in the order of their declarations.
    namespaces: Vec<Rc<str>>,
    ids: HashMap<Rc<str>, NamespaceId>,
    /// Open elements: the name as written, and the length of the scope outside.
    open: Vec<(&'a str, usize)>,
    /// Whether the last start tag was empty, so that its end is the next event.
    is_empty_tag: bool,
    has_root: bool,
    /// Raw attributes of a tag, reused.
    raw: Vec<(&'a str, Cow<'a, str>)>,
}

impl<'a> XmlReader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let mut reader = Self {
            text: text.strip_prefix('\u{feff}').unwrap_or(text),
            at: 0,
            attributes: Vec::new(),
            scope: Vec::new(),
            namespaces: Vec::new(),
            ids: HashMap::new(),
            open: Vec::new(),
            is_empty_tag: false,
            has_root: false,
            raw: Vec::new(),
        };
        let id = reader.add_namespace(XML);
        reader.scope.push(("xml", Some(id)));
        reader
    }

    /// The index of a namespace that the document has declared.
    pub(super) fn id_of(&self, namespace: &str) -> Option<NamespaceId> {
        self.ids.get(namespace).copied()
    }

    /// The namespace of an index.
    pub(super) fn namespace(&self, id: NamespaceId) -> Rc<str> {
        self.namespaces.get(id as usize).map_or_else(|| Rc::from(""), Rc::clone)
    }

    fn add_namespace(&mut self, namespace: &str) -> NamespaceId {
        let (id, shared) = (self.namespaces.len() as NamespaceId, Rc::<str>::from(namespace));
        self.namespaces.push(Rc::clone(&shared));
        self.ids.insert(shared, id);
        id
    }

    /// The namespace of a prefix in scope, the default namespace for an empty prefix.
    pub(super) fn lookup(&self, prefix: &str) -> Option<NamespaceId> {
        self.scope.iter().rev().find(|(known, _)| *known == prefix).and_then(|(_, id)| *id)
    }

    fn malformed(&self, problem: impl Into<String>) -> XmlError {
        let line = self.text.as_bytes()[..self.at].iter().filter(|byte| **byte == b'\n').count() + 1;
        XmlError::Malformed(line, problem.into())
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// Skips `text` and returns whether it was next.
    fn skip(&mut self, text: &str) -> bool {
        let is_next = self.rest().starts_with(text);
        self.at += if is_next { text.len() } else { 0 };
        is_next
    }

    fn skip_space(&mut self) -> usize {
        let is_space = |byte: &&u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n');
        let count = self.rest().as_bytes().iter().take_while(is_space).count();
        self.at += count;
        count
    }

    /// Returns the text before `end` and continues after it.
    fn until(&mut self, end: &str, what: &str) -> Result<&'a str, XmlError> {
        let Some(length) = self.rest().find(end) else {
            return Err(self.malformed(format!("{what} has no end")));
        };
        let text = &self.rest()[..length];
        self.at += length + end.len();
        Ok(text)
    }

    fn name(&mut self) -> Result<&'a str, XmlError> {
        let rest = self.rest();
        let ends = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b'/' | b'>' | b'=');
        let length = rest.as_bytes().iter().position(ends).unwrap_or(rest.len());
        let name = &rest[..length];
        if length > MAX_NAME_BYTES {
            return Err(XmlError::Bound(format!("an XML name of more than {MAX_NAME_BYTES} bytes")));
        }
        let starts = |c: char| c.is_alphabetic() || c == '_';
        let is_part = |part: &str| {
            part.starts_with(starts)
                && part.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '\u{b7}'))
        };
        if !name.splitn(2, ':').all(is_part) {
            return Err(self.malformed("expected the name of an element or an attribute"));
        }
        self.at += length;
        Ok(name)
    }

    /// Returns the next event.
    ///
    /// # Errors
    /// [`XmlError`] if the text is not well-formed or exceeds a bound.
    pub(super) fn next(&mut self) -> Result<Event<'a>, XmlError> {
        if std::mem::take(&mut self.is_empty_tag) {
            self.close();
            return Ok(Event::End);
        }
        loop {
            if self.open.is_empty() {
                self.skip_space();
                if self.at == self.text.len() {
                    return match self.has_root {
                        true => Ok(Event::Eof),
                        false => Err(self.malformed("the document has no element")),
                    };
                }
                if !self.rest().starts_with('<') {
                    return Err(self.malformed("text outside of the root element"));
                }
            }
            if !self.rest().starts_with('<') {
                return self.text_event();
            }
            if self.skip("<!--") {
                let comment = self.until("-->", "a comment")?;
                if comment.contains("--") || comment.ends_with('-') {
                    return Err(self.malformed("a comment contains '--'"));
                }
                self.refuse_characters(comment)?;
            } else if self.rest().starts_with("<![CDATA[") && !self.open.is_empty() {
                self.at += "<![CDATA[".len();
                let text = self.until("]]>", "a CDATA section")?;
                self.refuse_characters(text)?;
                return Ok(Event::Text(Cow::Borrowed(text)));
            } else if self.rest().starts_with("<!") {
                return Err(self.malformed("a document type declaration (DTD) is not allowed in a 3MF"));
            } else if self.rest().starts_with("<?") {
                let is_first = self.at == 0;
                self.at += "<?".len();
                self.instruction(is_first)?;
            } else if self.skip("</") {
                return self.end_tag();
            } else {
                self.at += 1;
                return self.start_tag();
            }
        }
    }

    /// Reads a processing instruction, or the declaration of XML at the begin of the document.
    fn instruction(&mut self, is_first: bool) -> Result<(), XmlError> {
        let text = self.until("?>", "a processing instruction")?;
        self.refuse_characters(text)?;
        let target = text.split(char::is_whitespace).next().unwrap_or_default();
        if !target.eq_ignore_ascii_case("xml") {
            return Ok(());
        }
        if !is_first || target != "xml" {
            return Err(self.malformed("a declaration of XML that is not at the beginning"));
        }
        let value = |key: &str| {
            let (_, value) = text.split_once(key)?;
            value.trim_start_matches(|c: char| c.is_whitespace() || c == '=').split(['"', '\'']).nth(1)
        };
        if value("version") != Some("1.0") {
            return Err(self.malformed("the declared version of XML is not 1.0"));
        }
        match value("encoding") {
            Some(name) if !name.eq_ignore_ascii_case("utf-8") => {
                Err(self.malformed("the declared encoding is not UTF-8"))
            }
            _ => Ok(()),
        }
    }

    /// Refuses characters that XML does not allow, such as a byte 01.
    fn refuse_characters(&self, text: &str) -> Result<(), XmlError> {
        // Nearly all texts are of ASCII: bytes are faster than characters.
        let is_plain =
            text.bytes().all(|byte| (b' '..0xef).contains(&byte) || matches!(byte, b'\t' | b'\n' | b'\r'));
        match is_plain || text.chars().all(is_character) {
            true => Ok(()),
            false => Err(self.malformed("a character that XML does not allow")),
        }
    }

    fn text_event(&mut self) -> Result<Event<'a>, XmlError> {
        let length = self.rest().find('<');
        let Some(length) = length else { return Err(self.malformed("an element has no end")) };
        let raw = &self.rest()[..length];
        if raw.contains("]]>") {
            return Err(self.malformed("text contains ']]>'"));
        }
        self.at += length;
        self.decoded(raw).map(Event::Text)
    }

    /// Replaces character references and the five predefined entities.
    fn decoded(&self, raw: &'a str) -> Result<Cow<'a, str>, XmlError> {
        self.refuse_characters(raw)?;
        if !raw.contains('&') {
            return Ok(Cow::Borrowed(raw));
        }
        let mut text = String::with_capacity(raw.len());
        let mut rest = raw;
        while let Some(start) = rest.find('&') {
            text.push_str(&rest[..start]);
            rest = &rest[start + 1..];
            // The longest reference is that of the last character, `#x10FFFF`.
            let end = rest.bytes().take(12).position(|byte| byte == b';');
            let character = end.and_then(|end| {
                Some(match &rest[..end] {
                    "lt" => '<',
                    "gt" => '>',
                    "amp" => '&',
                    "apos" => '\'',
                    "quot" => '"',
                    name => {
                        let number = name.strip_prefix('#')?;
                        let code = match number.strip_prefix('x') {
                            Some(digits) => u32::from_str_radix(digits, 16),
                            None => number.parse(),
                        };
                        char::from_u32(code.ok()?).filter(|c| is_character(*c))?
                    }
                })
            });
            let (Some(character), Some(end)) = (character, end) else {
                return Err(self.malformed("an unknown entity or character reference"));
            };
            text.push(character);
            rest = &rest[end + 1..];
        }
        text.push_str(rest);
        Ok(Cow::Owned(text))
    }

    fn start_tag(&mut self) -> Result<Event<'a>, XmlError> {
        if self.open.is_empty() && std::mem::replace(&mut self.has_root, true) {
            return Err(self.malformed("a second root element"));
        }
        if self.open.len() == MAX_DEPTH {
            return Err(XmlError::Bound(format!("more than {MAX_DEPTH} nested XML elements")));
        }
        let name = self.name()?;
        self.open.push((name, self.scope.len()));
        self.raw.clear();
        loop {
            let space = self.skip_space();
            if self.skip(">") {
                break;
            }
            if self.skip("/>") {
                self.is_empty_tag = true;
                break;
            }
            if space == 0 {
                return Err(self.malformed("expected a space or the end of a tag"));
            }
            self.attribute()?;
        }
        self.resolve(name)
    }

    fn attribute(&mut self) -> Result<(), XmlError> {
        let name = self.name()?;
        self.skip_space();
        if !self.skip("=") {
            return Err(self.malformed("an attribute has no value"));
        }
        self.skip_space();
        let quote = if self.skip("\"") {
            "\""
        } else if self.skip("'") {
            "'"
        } else {
            return Err(self.malformed("the value of an attribute is not in quotes"));
        };
        let raw = self.until(quote, "the value of an attribute")?;
        if raw.contains('<') {
            return Err(self.malformed("the value of an attribute contains '<'"));
        }
        let value = self.decoded(raw)?;
        let prefix = name.strip_prefix("xmlns:").or((name == "xmlns").then_some(""));
        match prefix {
            Some(prefix) => self.declare(prefix, &value),
            None if self.raw.len() == MAX_ATTRIBUTES => {
                Err(XmlError::Bound(format!("more than {MAX_ATTRIBUTES} attributes of an XML element")))
            }
            None => {
                self.raw.push((name, value));
                Ok(())
            }
        }
    }

    fn declare(&mut self, prefix: &'a str, namespace: &str) -> Result<(), XmlError> {
        let outside = self.open.last().map_or(0, |(_, length)| *length);
        if self.scope[outside..].iter().any(|(known, _)| *known == prefix) {
            return Err(self.malformed("a namespace is declared twice"));
        }
        if self.scope.len() > MAX_DECLARATIONS {
            return Err(XmlError::Bound(format!("more than {MAX_DECLARATIONS} XML namespaces in scope")));
        }
        if namespace.len() > MAX_NAME_BYTES {
            return Err(XmlError::Bound(format!("an XML namespace of more than {MAX_NAME_BYTES} bytes")));
        }
        let id = match self.id_of(namespace) {
            _ if namespace.is_empty() => None,
            Some(id) => Some(id),
            None if self.namespaces.len() == MAX_NAMESPACES => {
                return Err(XmlError::Bound(format!("more than {MAX_NAMESPACES} XML namespaces")));
            }
            None => Some(self.add_namespace(namespace)),
        };
        self.scope.push((prefix, id));
        Ok(())
    }

    /// Resolves the prefixes of a start tag.
    fn resolve(&mut self, name: &'a str) -> Result<Event<'a>, XmlError> {
        self.attributes.clear();
        for (name, value) in std::mem::take(&mut self.raw) {
            let (namespace, name) = match name.split_once(':') {
                Some((prefix, local)) => (Some(self.declared(prefix)?), local),
                None => (None, name),
            };
            let is_same = |a: &Attribute<'_>| a.name == name && a.namespace == namespace;
            if self.attributes.iter().any(is_same) {
                return Err(self.malformed(format!("the attribute {name} occurs twice")));
            }
            self.attributes.push(Attribute { namespace, name, value });
        }
        let (namespace, name) = match name.split_once(':') {
            Some((prefix, local)) => (Some(self.declared(prefix)?), local),
            None => (self.lookup(""), name),
        };
        Ok(Event::Start { namespace, name })
    }

    fn declared(&self, prefix: &str) -> Result<NamespaceId, XmlError> {
        self.lookup(prefix)
            .ok_or_else(|| self.malformed(format!("the namespace prefix {prefix} is not declared")))
    }

    fn end_tag(&mut self) -> Result<Event<'a>, XmlError> {
        let name = self.name()?;
        self.skip_space();
        let is_open = self.open.last().is_some_and(|(open, _)| *open == name);
        if !is_open || !self.skip(">") {
            return Err(self.malformed(format!("</{name}> does not end an element")));
        }
        self.close();
        Ok(Event::End)
    }

    fn close(&mut self) {
        if let Some((_, length)) = self.open.pop() {
            self.scope.truncate(length);
        }
    }
}

/// Whether XML 1.0 allows a character (production 2, `Char`).
const fn is_character(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_characters_and_forms_of_xml_are_read() {
        for malformed in [
            "<a>\u{1}</a>",
            "<a b=\"\u{b}\"/>",
            "<a>\u{ffff}</a>",
            "<a>&#1;</a>",
            "<a><!-- a -- b --></a>",
            "<a><!-- a ---></a>",
            "<a>]]></a>",
            "<a><?xml version=\"1.0\"?></a>",
            " <?xml version=\"1.0\"?><a/>",
            "<?xml version=\"1.1\"?><a/>",
            "<?XML version=\"1.0\"?><a/>",
        ] {
            assert!(read(malformed).is_err(), "{malformed:?}");
        }
        for good in [
            "<a>&#127;&#x85;\u{85}</a>",
            "<?xml version='1.0'?><a/>",
            "<a><?x y?><!-- - --></a>",
            "<a>]]</a>",
        ] {
            assert!(read(good).is_ok(), "{good:?}");
        }
    }

    /// Names of the elements and the texts of a document.
    fn read(text: &str) -> Result<Vec<String>, XmlError> {
        let mut reader = XmlReader::new(text);
        let mut all = Vec::new();
        loop {
            match reader.next()? {
                Event::Start { namespace, name } => {
                    let namespace = namespace.map(|id| reader.namespace(id)).unwrap_or_else(|| "".into());
                    let attributes: String =
                        reader.attributes.iter().map(|a| format!(" {}={}", a.name, a.value)).collect();
                    all.push(format!("<{{{namespace}}}{name}{attributes}>"));
                }
                Event::End => all.push("/".to_owned()),
                Event::Text(text) => all.push(text.into_owned()),
                Event::Eof => return Ok(all),
            }
        }
    }

    #[test]
    fn documents_are_read() {
        for (text, expected) in [
            ("\u{feff}<?xml version='1.0' encoding='utf-8'?><!-- <a> --><a/>", "<{}a>/"),
            ("<a b = '1' c=\"&lt;&#65;&#x42;\"> x &amp; y<![CDATA[<&]]></a >", "<{}a b=1 c=<AB> x & y<&/"),
            ("<p:a xmlns:p='u' xmlns='v'><b p:c='d'/></p:a>", "<{u}a><{v}b c=d>//"),
            ("<a xmlns='u'><b xmlns=''/><c/></a>", "<{u}a><{}b>/<{u}c>//"),
        ] {
            assert_eq!(read(text).unwrap().concat(), expected, "{text}");
        }
    }

    #[test]
    fn malformed_documents_are_refused() {
        for text in [
            "",
            "x",
            "<a",
            "<a>",
            "<a></b>",
            "<a/><b/>",
            "<a b/>",
            "<a b=c/>",
            "<a b='1' b='2'/>",
            "<a>&b;</a>",
            "<p:a/>",
            "<a p:b='1'/>",
            "<!DOCTYPE a><a/>",
            "<a b='<'/>",
            "<a/>x",
            "</a>",
            "<1/>",
            "<?xml version='1.0' encoding='UTF-16'?><a/>",
            "<a b='1'c='2'/>",
            "<a>&#0;</a>",
            "<!--<a/>",
            "<a xmlns:p='u' xmlns:q='u' p:b='1' q:b='2'/>",
        ] {
            assert!(matches!(read(text), Err(XmlError::Malformed(..))), "{text}: {:?}", read(text));
        }
        assert!(matches!(read("<a>\n\n&b;</a>"), Err(XmlError::Malformed(3, _))));
    }

    #[test]
    fn excessive_documents_meet_a_bound() {
        let deep = "<a>".repeat(1000);
        let attributes = format!("<a {}/>", (0..1000).map(|i| format!("b{i}='' ")).collect::<String>());
        let declared = format!("<a {}/>", (0..1000).map(|i| format!("xmlns:b{i}='u' ")).collect::<String>());
        let many: String = (0..1000).map(|i| format!("<a xmlns='u{i}'/>")).collect();
        let (name, namespace) =
            (format!("<{}/>", "a".repeat(3000)), format!("<a xmlns='{}'/>", "u".repeat(3000)));
        for text in [deep, attributes, declared, format!("<a>{many}</a>"), name, namespace] {
            assert!(matches!(read(&text), Err(XmlError::Bound(_))), "{text:.60}");
        }
    }
}
