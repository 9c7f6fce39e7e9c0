// Where the focus goes when what has it is removed, hidden or disabled. Left to the browser it falls to the page's beginning,
// and who walks with the keyboard walks all of it again.

const FOCUSABLE = 'a[href], button, input, select, summary, [tabindex]';

const canTakeFocus = (element) => element.isConnected && !element.disabled && (element.checkVisibility?.({ visibilityProperty: true }) ?? element.getClientRects().length > 0);
const stopsIn = (host) => [...host.querySelectorAll(FOCUSABLE)].filter((e) => e.tabIndex >= 0);
const nameOf = (element) => element.getAttribute('aria-label') ?? element.textContent;

class Focus {
  constructor() {
    this.last = null;
    addEventListener('focusin', ({ target }) => this.remember(target));
    addEventListener('focusout', () => setTimeout(() => this.left()));
    new MutationObserver(() => this.check()).observe(document.body, { subtree: true, childList: true, attributes: true, attributeFilter: ['hidden', 'disabled', 'open', 'class'] });
  }

  // What stands around it, for when it is gone.
  remember(element) {
    const around = [];
    for (let host = element.parentElement; host; host = host.parentElement) around.push(host);
    this.last = { element, around, stops: stopsIn(document), name: nameOf(element), isSeen: element.matches(':focus-visible') };
  }

  // Who clicks beside what has the focus has left it, if it is still there a moment later.
  left() { if (this.last && document.activeElement === document.body && canTakeFocus(this.last.element)) this.last = null; }

  check() {
    const at = document.activeElement;
    if (!this.last || (at && at !== document.body && canTakeFocus(at)) || canTakeFocus(this.last.element)) return;
    const { isSeen } = this.last;
    const heir = this.heir(this.last);
    this.last = null;
    // A hand at the mouse did not ask to be scrolled away.
    heir?.focus({ preventScroll: !isSeen });
  }

  // The same drawn anew; else whom it names in `data-heir`; else what stands next, in what is closest around it: there its
  // one box of `data-home`, if it has one.
  heir({ element, around, stops, name }) {
    const hosts = around.filter((host) => host.isConnected);
    const twin = stopsIn(hosts[0]).find((e) => e.tagName === element.tagName && nameOf(e) === name && canTakeFocus(e));
    const named = (element.dataset.heir ?? '').split(' ').map((id) => byId(id));
    const own = twin ?? named.find((e) => e && canTakeFocus(e));
    if (own) return own;
    const place = stops.indexOf(element);
    const order = [...stops.slice(place + 1), ...stops.slice(0, place).reverse()];
    for (const host of hosts) {
      const near = stopsIn(host).filter(canTakeFocus);
      const homes = near.filter((e) => 'home' in e.dataset);
      const next = (homes.length === 1 ? homes[0] : undefined) ?? order.find((e) => near.includes(e)) ?? near[0];
      if (next) return next;
    }
    return null;
  }
}
