// The published page as an app: a browser offers to install a page that names a manifest. The manifest is made here, since
// a page of one file does not know the address under which it is published.

const ICON = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 64 64"><rect width="64" height="64" rx="12" fill="#00589b"/><path d="M10 50a26 26 0 0 1 44 0" fill="none" stroke="#9ccae8" stroke-width="9"/><path d="M4 38C18 18 46 18 60 38" fill="none" stroke="#fff" stroke-width="5" stroke-linecap="round"/><g fill="#e0a23b"><circle cx="17" cy="34" r="4.5"/><circle cx="32" cy="29" r="4.5"/><circle cx="47" cy="34" r="4.5"/></g></svg>';
const dataUrl = (type, text) => `data:${type},${encodeURIComponent(text)}`;

function nameApp() {
  const icon = dataUrl('image/svg+xml', ICON);
  document.querySelector('link[rel=icon]').href = icon;
  if (document.body.dataset.state !== 'file' || !/^https?:$/.test(location.protocol) || isEmbedded()) return;
  const address = location.href.replace(/#.*/, '');
  const manifest = {
    name: TEXT.title, short_name: TEXT.brand, description: TEXT.intro, id: address, start_url: address, scope: new URL('.', address).href,
    display: 'standalone', background_color: '#fbfbf9', theme_color: '#00589b', icons: [{ src: icon, sizes: 'any', type: 'image/svg+xml' }],
  };
  document.head.append(make('link', undefined, { rel: 'manifest', href: dataUrl('application/manifest+json', JSON.stringify(manifest)) }));
}
