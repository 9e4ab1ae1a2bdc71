// Light or dark: as somebody chose on this page, else as the system has it.
const KEPT = 'palpate.theme';

export class Theme {
  /** `changed` is called at once, and whenever it changes. */
  constructor(private readonly changed: (dark: boolean) => void) {
    const system = matchMedia('(prefers-color-scheme: dark)');
    this.apply(localStorage.getItem(KEPT) ?? (system.matches ? 'dark' : 'light'));
    system.addEventListener('change', (event) => {
      if (!localStorage.getItem(KEPT)) this.apply(event.matches ? 'dark' : 'light');
    });
  }
  toggle(): void {
    const theme = document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark';
    localStorage.setItem(KEPT, theme);
    this.apply(theme);
  }
  private apply(theme: string): void {
    document.documentElement.dataset['theme'] = theme;
    this.changed(theme === 'dark');
  }
}
